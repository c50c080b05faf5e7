/* Engraves text: finds its place, makes the solid of its letters, and cuts it out or adds it. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"
#include "core/mesh/mesh.h"
#include "simplify/engrave/find_place.h"

#include <cubewright/boolean.h>

#include <string.h>

/* Edges of letters are creases of normals beyond this angle. */
static const double CREASE_DEG = 60;

static cw_status check_desc(const cw_engrave_desc *d, cw_error *err)
{
    const struct {
        const char *name;
        double value;
    } rows[] = {{"size_mm", d->size_mm},
                {"depth_mm", d->depth_mm},
                {"stroke_mm", d->stroke_mm},
                {"wall_mm", d->wall_mm}};
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++)
        if (!(rows[n].value >= 0) || !isfinite(rows[n].value))
            return cwi_fail(err, CW_ERR_ARGUMENT, "%s is %g; it must be 0 or more",
                            rows[n].name, rows[n].value);
    for (int a = 0; a < 3; a++)
        if (!isfinite(d->direction[a]) || (d->has_at && !isfinite(d->at[a])))
            return cwi_fail(err, CW_ERR_ARGUMENT, "%s is not finite",
                            isfinite(d->direction[a]) ? "at" : "direction");
    return CW_OK;
}

/* Cuts the letters out, or adds them. */
static cw_status join_letters(const cw_mesh *mesh, const cwi_placed_text *placed,
                              const cw_engrave_desc *d, cw_mesh *out, cw_error *err)
{
    const cw_mesh *both[2] = {mesh, &placed->tool};
    const cwi_part_progress part = {&d->progress, 0.4, 0.6};
    const cw_boolean_desc desc = {.op = d->emboss ? CW_BOOLEAN_UNION : CW_BOOLEAN_DIFFERENCE,
                                  .threads = d->threads,
                                  .progress = cwi_progress_part(&part)};
    return cw_mesh_boolean(both, 2, &desc, out, NULL, err);
}

/* Gives the result normals if the mesh has them, and removes the marks of the boolean. */
static cw_status finish_mesh(const cw_mesh *mesh, cw_mesh *out, cw_error *err)
{
    cw_status st = CW_OK;
    cw_mesh_attribute_remove(out, CW_CORNER_NORMALS);
    if (mesh->normals)
        st = cw_mesh_normals(out, err);
    const cw_attribute *input = cw_mesh_attribute_find(out, "input");
    if (st == CW_OK && mesh->normals && input) {
        uint8_t *regions = cwi_alloc_array(out->triangle_count, sizeof *regions);
        if (!regions)
            return cwi_fail_memory(err);
        for (size_t t = 0; t < out->triangle_count; t++)
            regions[t] = ((const uint32_t *)input->data)[t] > 0;
        st = cw_mesh_crease_normals(out, CREASE_DEG, regions, NULL, err);
        cwi_free(regions);
    }
    if (!cw_mesh_attribute_find(mesh, "input"))
        cw_mesh_attribute_remove(out, "input");
    return st;
}

static void fill_facts(const cw_mesh *mesh, const cwi_text_lines *lines,
                       const cwi_placed_text *placed, cw_engrave_facts *facts)
{
    const cwi_text_size *t = &placed->size;
    const cwi_stroke_region *r = &placed->region;
    double area = 0;
    for (size_t n = 0; n < r->triangle_count; n++) {
        const double *a = r->points[r->triangles[n][0]], *b = r->points[r->triangles[n][1]],
                     *c = r->points[r->triangles[n][2]];
        area += ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2;
    }
    *facts = (cw_engrave_facts){
        .size_mm = t->size,
        .stroke_mm = t->stroke,
        .depth_mm = t->depth,
        .wall_mm = t->wall,
        .width_mm = t->width,
        .height_mm = t->height,
        .deviation_mm = placed->look.deviation,
        .lean_deg = placed->look.lean_deg,
        .thickness_mm = placed->look.thickness,
        .volume_mm3 = area * t->depth,
        .characters = lines->characters,
    };
    for (int a = 0; a < 3; a++) {
        facts->center[a] = mesh->origin[a] + placed->place.center[a];
        facts->normal[a] = placed->place.normal[a] + 0.0; /* -0 becomes 0 */
        facts->right[a] = placed->place.right[a] + 0.0;
    }
}

cw_status cw_mesh_engrave(const cw_mesh *mesh, const cw_engrave_desc *desc, cw_mesh *out,
                          cw_engrave_facts *facts, cw_error *err)
{
    CWI_REQUIRE(err, mesh, desc, out);
    CWI_REQUIRE_VERSION(err, desc, 0);
    CWI_REQUIRE_VERSION(err, facts, 0);
    cwi_text_lines lines = {0};
    cwi_ray_target target = {0};
    cwi_placed_text placed = {0};
    *out = (cw_mesh){0};
    cw_status st = cwi_mesh_check_size(mesh, "engraved", err);
    if (st == CW_OK)
        st = check_desc(desc, err);
    if (st == CW_OK)
        st = cwi_lay_out_text(desc->text ? desc->text : "", &lines, err);
    if (st == CW_OK && mesh->triangle_count == 0)
        st = cwi_fail(err, CW_ERR_EMPTY, "the mesh has no triangles");
    if (st == CW_OK)
        st = cwi_ray_target_build(&target, mesh, err);
    if (st == CW_OK)
        st = cwi_place_text(&target, &lines, desc, &placed, err);
    if (st == CW_OK)
        st = join_letters(mesh, &placed, desc, out, err);
    if (st == CW_OK)
        st = finish_mesh(mesh, out, err);
    if (st == CW_OK && facts)
        fill_facts(mesh, &lines, &placed, facts);
    cwi_free_placed(&placed);
    cwi_ray_target_free(&target);
    cwi_free_text_lines(&lines);
    if (st != CW_OK)
        cw_mesh_free(out);
    return st;
}
