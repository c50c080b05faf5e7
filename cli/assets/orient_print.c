/* Finds how a mesh prints with the least support, turns it, and tells of both ways to stand. */
#include "cli/assets/orient_print.h"

#include "cli/framework/console.h"
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/texture/gather_meshes.h"

#include <stdlib.h>

cw_status cli_check_orient(const cli_number *angle, cw_error *err)
{
    if (!angle->given || angle->is_word || (angle->value > 0 && angle->value < 90))
        return CW_OK;
    return cwi_fail(err, CW_ERR_ARGUMENT,
                    "--orient-print %g: expected auto, or degrees above 0 and below 90",
                    angle->value);
}

static cw_mesh *find_part(cli_mesh *m, size_t n)
{
    return m->parts ? (cw_mesh *)(uintptr_t)m->parts[n].mesh : &m->mesh;
}

/* Finds the orientation of all parts as one mesh. */
static cw_status find_orientation(const cw_print_desc *desc, cli_mesh *m, size_t count,
                                  cw_orient_facts *facts, cw_error *err)
{
    cw_mesh all = {0};
    const cw_mesh **meshes = calloc(count, sizeof *meshes);
    if (!meshes)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < count; n++)
        meshes[n] = find_part(m, n);
    cw_status st = cwi_gather_meshes(meshes, NULL, count, false, false, &all, err);
    if (st == CW_OK)
        st = cw_orient_print(&all, desc, facts, err);
    cw_mesh_free(&all);
    free(meshes);
    return st;
}

static void tell_orientation(const cli_mesh *m, const cw_orient_facts *f)
{
    const cw_print_stand *a = &f->after, *b = &f->before;
    if (f->is_kept) {
        cli_say(
            "%s: stays as it is: of %zu poses none prints with less support; overhangs %.4g mm2, height "
            "%.4g mm, on a hull of %.4g mm2, tips over at %.3g degrees",
            m->path, f->poses, a->overhang_mm2, a->height_mm, a->hull_mm2, a->tip_deg);
    } else {
        cli_say(
            "%s: turned so that %.4g %.4g %.4g is up: overhangs %.4g mm2 (%.4g before), height %.4g mm "
            "(%.4g), on a hull of %.4g mm2 (%.4g), tips over at %.3g degrees (%.3g)",
            m->path, a->up[0], a->up[1], a->up[2], a->overhang_mm2, b->overhang_mm2,
            a->height_mm, b->height_mm, a->hull_mm2, b->hull_mm2, a->tip_deg, b->tip_deg);
    }
    if (!f->is_stable)
        cli_say(
            "%s: no pose stands without tipping over below %g degrees: the print needs a brim or a cut "
            "(--cut-plane)",
            m->path, CW_MIN_TIP_DEG);
}

cw_status cli_orient_for_print(const cli_number *angle, int threads, cli_mesh *m,
                               cw_orient_facts *facts, cw_error *err)
{
    const size_t count = m->parts ? m->part_count : 1;
    const cw_print_desc desc = {.overhang_deg = angle->is_word ? 0 : angle->value,
                                .threads = threads};
    cw_status st = find_orientation(&desc, m, count, facts, err);
    for (size_t n = 0; n < count && st == CW_OK && !facts->is_kept; n++)
        st = cw_mesh_transform(find_part(m, n), facts->matrix, err);
    if (st == CW_OK)
        tell_orientation(m, facts);
    return st == CW_OK ? st : cwi_fail_in(err, st, m->path);
}

static void json_stand(cli_json *j, const char *key, const cw_print_stand *s)
{
    cli_json_open(j, key, '{');
    cli_json_numbers(j, "up", s->up, 3);
    cli_json_number(j, "overhang_mm2", s->overhang_mm2);
    cli_json_number(j, "height_mm", s->height_mm);
    cli_json_number(j, "hull_mm2", s->hull_mm2);
    cli_json_number(j, "tip_deg", s->tip_deg);
    cli_json_close(j, '}');
}

void cli_json_orient(cli_json *j, const cw_orient_facts *f)
{
    if (!f->poses)
        return;
    cli_json_open(j, "orient_print", '{');
    json_stand(j, "before", &f->before);
    json_stand(j, "after", &f->after);
    cli_json_numbers(j, "matrix", f->matrix, 12);
    cli_json_count(j, "directions", f->directions);
    cli_json_count(j, "poses", f->poses);
    cli_json_count(j, "unstable", f->unstable);
    cli_json_bool(j, "stable", f->is_stable);
    cli_json_bool(j, "kept", f->is_kept);
    cli_json_close(j, '}');
}
