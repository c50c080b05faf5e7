/* Samples a volume at the vertices of a mesh, and colours vertices by their scalars. */
#include "core/color/cell_sample.h"
#include "core/color/colormap.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/mesh/mesh_triangle.h"

#include <math.h>
#include <string.h>

enum { PART = 1 << 12 };

typedef struct sampling {
    const cw_mesh *mesh;
    const cw_volume *volume; /* resolved */
    cwi_cell_sampler cells;  /* of an irregular grid */
    float *scalars;
} sampling;

/* Samples at the nearest point of the box of voxels, if that is no farther than half a voxel: caps of
 * extracted surfaces are a little outside. */
static double sample_beside(const cw_volume *v, const double world[3])
{
    double index[3], inside[3];
    if (cw_volume_to_index(v, world, index, NULL) != CW_OK)
        return NAN;
    for (int a = 0; a < 3; a++) {
        const double last = (double)v->dim[a] - 1;
        if (!(index[a] >= -0.5 && index[a] <= last + 0.5))
            return NAN;
        index[a] = fmax(0, fmin(index[a], last));
    }
    cw_volume_to_world(v, index, inside);
    return cw_volume_sample(v, inside);
}

static void sample_part(void *context, size_t k)
{
    const sampling *s = context;
    for (size_t v = k * PART; v < (k + 1) * PART && v < s->mesh->vertex_count; v++) {
        double world[3];
        cwi_mesh_world(s->mesh, v, world);
        double value = s->volume->cells ? cwi_cell_sample(&s->cells, world)
                                        : cw_volume_sample(s->volume, world);
        if (isnan(value) && !s->volume->cells)
            value = sample_beside(s->volume, world);
        s->scalars[v] = (float)value;
    }
}

/* Finds the range, and gives it to those without a value: the lowest. */
static cw_sample_facts fill_missing(float *scalars, size_t count)
{
    cw_sample_facts facts = {.low = INFINITY, .high = -INFINITY};
    for (size_t v = 0; v < count; v++)
        if (isfinite(scalars[v])) {
            facts.low = fmin(facts.low, (double)scalars[v]);
            facts.high = fmax(facts.high, (double)scalars[v]);
        } else {
            facts.missing++;
        }
    for (size_t v = 0; v < count && facts.missing < count; v++)
        if (!isfinite(scalars[v]))
            scalars[v] = (float)facts.low;
    return facts;
}

static cw_status resolve_volume(const cw_volume *volume, cw_volume *out, cw_error *err)
{
    cw_status st = cw_volume_select(volume, 0, 0, out, err);
    if (st == CW_OK && out->sparse)
        st = cwi_fail(err, CW_ERR_UNSUPPORTED,
                      "colours of a sparse volume need cw_volume_densify() before");
    return st;
}

cw_status cw_mesh_sample(cw_mesh *mesh, const cw_volume *volume, const cw_sample_desc *desc,
                         cw_sample_facts *facts, cw_error *err)
{
    CWI_REQUIRE(err, mesh, volume);
    CWI_REQUIRE_VERSION(err, desc, 0);
    const cw_sample_desc d = desc ? *desc : (cw_sample_desc){0};
    cw_volume view;
    cw_sample_facts found = {0};
    sampling s = {.mesh = mesh, .volume = &view};
    const size_t count = mesh->vertex_count;
    if (facts)
        *facts = found;
    cw_status st = cw_mesh_check(mesh, err);
    if (st == CW_OK)
        st = resolve_volume(volume, &view, err);
    if (st != CW_OK || count == 0)
        return st;
    s.scalars = cwi_alloc_array(count, sizeof *s.scalars);
    if (!s.scalars)
        return cwi_fail_memory(err);
    if (view.cells)
        st = cwi_cell_sampler_build(&view, &s.cells, err);
    if (st == CW_OK)
        st = cwi_parallel_for((count + PART - 1) / PART, 64 * PART, d.threads, &d.progress,
                              "sampling", sample_part, &s, err);
    cwi_cell_sampler_free(&s.cells);
    if (st == CW_OK) {
        found = fill_missing(s.scalars, count);
        if (found.missing == count)
            st = cwi_fail(err, CW_ERR_EMPTY,
                          "none of the %zu vertices is inside of the volume of colours", count);
    }
    if (st == CW_OK && facts)
        *facts = found;
    if (st == CW_OK && !mesh->scalars) {
        mesh->scalars = s.scalars;
        return CW_OK;
    }
    if (st == CW_OK)
        memcpy(mesh->scalars, s.scalars, count * sizeof *s.scalars);
    cwi_free(s.scalars);
    return st;
}

cw_status cw_mesh_color(cw_mesh *mesh, cw_colormap map, double low, double high, cw_error *err)
{
    CWI_REQUIRE(err, mesh);
    if (!cw_colormap_name(map))
        return cwi_fail(err, CW_ERR_ARGUMENT, "map is %d; it must be 0 to %d", (int)map,
                        CW_COLORMAP_COUNT - 1);
    if (!isfinite(low) || !isfinite(high) || !(low <= high))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "low is %g and high %g; they must be finite, and high not below low",
                        low, high);
    cw_status st = cw_mesh_check(mesh, err);
    if (st != CW_OK)
        return st;
    if (!mesh->scalars && mesh->vertex_count)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "the mesh has no scalars; cw_mesh_sample() adds "
                        "them");
    if (!mesh->colors)
        mesh->colors = cwi_alloc_array(mesh->vertex_count, 4);
    uint8_t *colors = mesh->colors;
    if (!colors)
        return cwi_fail_memory(err);
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        const double value = (double)mesh->scalars[v];
        const double fraction = high > low     ? (value - low) / (high - low)
                                : value > high ? 1
                                               : 0;
        cw_colormap_color(map, fraction, colors + 4 * v);
        colors[4 * v + 3] = 255;
    }
    return CW_OK;
}
