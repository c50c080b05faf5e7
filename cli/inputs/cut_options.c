/* Cuts meshes by --cut-plane, and says what that did. */
#include "cli/inputs/cut_options.h"

#include "cli/framework/console.h"
#include "cli/framework/quantity.h"
#include "core/base/status.h"
#include "core/geometry/box.h"

#include <math.h>
#include <string.h>

cw_cut_desc cli_cut_desc(const cli_plane *plane)
{
    cw_cut_desc d = {.point_is_percent = plane->is_percent};
    memcpy(d.normal, plane->normal, sizeof d.normal);
    memcpy(d.point, plane->point, sizeof d.point);
    return d;
}

/* Cuts a mesh in place, adds to the facts, and names the option in errors.
 * low, high  the box of which percents are */
static cw_status cut_mesh(const cli_plane *plane, const double low[3], const double high[3],
                          cw_mesh *mesh, cw_cut_facts *facts, cw_error *err)
{
    cw_cut_desc desc = cli_cut_desc(plane);
    for (int a = 0; a < 3; a++)
        if (desc.point_is_percent && desc.normal[a] != 0)
            desc.point[a] = low[a] + (high[a] - low[a]) * desc.point[a] / 100;
    desc.point_is_percent = false;
    cw_mesh cut;
    cw_cut_facts f;
    desc.progress = cli_progress((double)mesh->triangle_count / 1e6, "Mtriangle");
    cw_status st = cw_mesh_cut(mesh, &desc, &cut, &f, err);
    if (st != CW_OK)
        return cwi_fail_in(err, st, "--cut-plane");
    cw_mesh_free(mesh);
    *mesh = cut;
    facts->cut_triangles += f.cut_triangles;
    facts->dropped_triangles += f.dropped_triangles;
    facts->cap_triangles += f.cap_triangles;
    facts->loops_closed += f.loops_closed;
    facts->loops_open += f.loops_open;
    facts->area_mm2 += f.area_mm2;
    facts->moved_mm = fmax(facts->moved_mm, f.moved_mm);
    return CW_OK;
}

/* Returns the n-th part of a mesh, or all of it if it is merged. */
static cw_mesh *find_part(cli_mesh *m, size_t n)
{
    return m->parts ? (cw_mesh *)(uintptr_t)m->parts[n].mesh : &m->mesh;
}

cw_status cli_cut_parts(const cli_plane *plane, cli_mesh *m, cw_cut_facts *facts, cw_error *err)
{
    const size_t count = m->parts ? m->part_count : 1;
    double low[3], high[3];
    size_t kept = 0;
    cw_status st = CW_OK;
    cwi_box_clear(low, high);
    for (size_t n = 0; n < count; n++) {
        double box[2][3];
        if (cw_mesh_bounds(find_part(m, n), box[0], box[1]))
            cwi_box_join(low, high, box[0], box[1]);
    }
    for (size_t n = 0; n < count && st == CW_OK; n++) {
        cw_mesh *part = find_part(m, n);
        st = cw_mesh_weld(part, NULL, err);
        if (st == CW_OK)
            st = cut_mesh(plane, low, high, part, facts, err);
        kept += st == CW_OK;
        if (st == CW_ERR_EMPTY && count > 1) {
            facts->dropped_triangles += part->triangle_count;
            part->triangle_count = part->vertex_count = 0;
            st = CW_OK;
        }
    }
    if (st == CW_OK && !kept)
        st = cwi_fail(err, CW_ERR_EMPTY, "--cut-plane: nothing is left above the plane");
    if (st != CW_OK)
        return cwi_fail_in(err, st, m->path);
    cli_tell_cut(m->path, plane, facts);
    return CW_OK;
}

void cli_tell_cut(const char *path, const cli_plane *plane, const cw_cut_facts *f)
{
    cli_say("%s: cut at %s: %s triangles left out, %s loop%s closed, %.6g mm2", path,
            cli_plane_text(plane), cli_count(f->dropped_triangles), cli_count(f->loops_closed),
            f->loops_closed == 1 ? "" : "s", f->area_mm2);
    if (f->loops_open)
        cli_say("%s: %s line%s of the section end at open edges, and stay open", path,
                cli_count(f->loops_open), f->loops_open == 1 ? "" : "s");
}

void cli_json_cut(cli_json *j, const cw_cut_facts *f)
{
    cli_json_open(j, "cut", '{');
    cli_json_count(j, "cut_triangles", f->cut_triangles);
    cli_json_count(j, "dropped_triangles", f->dropped_triangles);
    cli_json_count(j, "cap_triangles", f->cap_triangles);
    cli_json_count(j, "loops_closed", f->loops_closed);
    cli_json_count(j, "loops_open", f->loops_open);
    cli_json_number(j, "area_mm2", f->area_mm2);
    cli_json_close(j, '}');
}
