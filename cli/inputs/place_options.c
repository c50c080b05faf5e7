/* Scales, mirrors and turns meshes, and moves them to their pivot. */
#include "cli/inputs/place_options.h"

#include "cli/framework/console.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "core/geometry/box.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const char *const pivots[] = {"file", "base", "centre"};

/* --- the kind of rotations ---------------------------------------------------------------- */

/* x:90,z:45 */
static bool parse_rotation(const cli_option *o, const char *text, void *field)
{
    cli_rotation *out = field;
    (void)o;
    *out = (cli_rotation){0};
    if (strlen(text) >= sizeof out->text)
        return false;
    snprintf(out->text, sizeof out->text, "%s", text);
    do {
        if (out->count == CLI_MAX_ROTATIONS || *text < 'x' || *text > 'z' || text[1] != ':')
            return false;
        out->axis[out->count] = *text - 'x';
        text += 2;
        if (!cwi_parse_double(&text, &out->degrees[out->count]) ||
            !isfinite(out->degrees[out->count]))
            return false;
        out->count++;
    } while (*text++ == ',');
    return text[-1] == '\0';
}

static void print_rotation(const cli_option *o, const void *field, char *text, size_t size)
{
    (void)o;
    snprintf(text, size, "%s", ((const cli_rotation *)field)->text);
}

const cli_kind cli_kind_rotation = {
    sizeof(cli_rotation),
    parse_rotation,
    print_rotation,
    "an axis and an angle in degrees such as z:90, or up to 8 by comma such as x:90,z:45",
    NULL,
    0};

/* --- the map ------------------------------------------------------------------------------ */

bool cli_places(const cli_placing *p)
{
    return p->scale.count || p->mirror || p->rotation.count || p->pivot;
}

cw_status cli_check_placing(const cli_placing *p, cw_error *err)
{
    if (p->scale.count && p->scale.count != 1 && p->scale.count != 3)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--scale has %zu factors: one was expected, or one for each axis",
                        p->scale.count);
    for (size_t n = 0; n < p->scale.count; n++)
        if (!(p->scale.value[n] > 0))
            return cwi_fail(err, CW_ERR_ARGUMENT,
                            "--scale %g: a factor above 0 was expected; --mirror swaps sides",
                            p->scale.value[n]);
    return CW_OK;
}

/* Turns the linear part of a map; right angles are exact. */
static void add_rotation(int axis, double degrees, double map[12])
{
    const double turns = degrees / 90, whole = round(turns);
    const bool is_right = turns == whole;
    const int quarter = is_right ? (int)fmod(fmod(whole, 4) + 4, 4) : 0;
    const double angle = degrees * acos(-1) / 180;
    const double c = is_right ? (double[]){1, 0, -1, 0}[quarter] : cos(angle);
    const double s = is_right ? (double[]){0, 1, 0, -1}[quarter] : sin(angle);
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (int column = 0; column < 3; column++) {
        const double x = map[4 * u + column], y = map[4 * v + column];
        map[4 * u + column] = c * x - s * y;
        map[4 * v + column] = s * x + c * y;
    }
}

static void make_map(const cli_placing *p, double map[12])
{
    memset(map, 0, 12 * sizeof *map);
    for (int a = 0; a < 3; a++) {
        const double factor =
            p->scale.count == 0 ? 1 : p->scale.value[p->scale.count == 1 ? 0 : a];
        map[4 * a + a] = p->mirror == 1 + a ? -factor : factor;
    }
    for (size_t n = 0; n < p->rotation.count; n++)
        add_rotation(p->rotation.axis[n], p->rotation.degrees[n], map);
}

/* Returns the n-th part of a mesh, or all of it if it is merged. */
static cw_mesh *find_part(cli_mesh *m, size_t n)
{
    return m->parts ? (cw_mesh *)(uintptr_t)m->parts[n].mesh : &m->mesh;
}

static void find_box(cli_mesh *m, size_t count, double low[3], double high[3])
{
    cwi_box_clear(low, high);
    for (size_t n = 0; n < count; n++) {
        double box[2][3];
        if (cw_mesh_bounds(find_part(m, n), box[0], box[1]))
            cwi_box_join(low, high, box[0], box[1]);
    }
}

static cw_status move_parts(cli_mesh *m, size_t count, const double map[12], cw_error *err)
{
    cw_status st = CW_OK;
    for (size_t n = 0; n < count && st == CW_OK; n++)
        st = cw_mesh_transform(find_part(m, n), map, err);
    return st == CW_OK ? st : cwi_fail_in(err, st, m->path);
}

/* Finds the way from the middle of a box, or of its lower side, to 0,0,0. */
static void find_way(int pivot, const double low[3], const double high[3], double way[3])
{
    for (int a = 0; a < 3; a++)
        way[a] = -(low[a] + (high[a] - low[a]) / 2);
    if (pivot == CLI_PIVOT_BASE)
        way[2] = -low[2];
}

static cw_status move_to_pivot(int pivot, cli_mesh *m, size_t count, cw_error *err)
{
    double low[3], high[3], way[3];
    find_box(m, count, low, high);
    if (!(low[0] <= high[0]))
        return CW_OK;
    find_way(pivot, low, high, way);
    const double map[12] = {1, 0, 0, way[0], 0, 1, 0, way[1], 0, 0, 1, way[2]};
    return move_parts(m, count, map, err);
}

cw_status cli_move_to_pivot(int pivot, cw_mesh *meshes, size_t count, double moved[3],
                            cw_error *err)
{
    double low[3], high[3], box[2][3];
    cw_status st = CW_OK;
    moved[0] = moved[1] = moved[2] = 0;
    if (pivot == CLI_PIVOT_FILE)
        return CW_OK;
    cwi_box_clear(low, high);
    for (size_t n = 0; n < count; n++)
        if (cw_mesh_bounds(&meshes[n], box[0], box[1]))
            cwi_box_join(low, high, box[0], box[1]);
    if (!(low[0] <= high[0]))
        return CW_OK;
    find_way(pivot, low, high, moved);
    const double map[12] = {1, 0, 0, moved[0], 0, 1, 0, moved[1], 0, 0, 1, moved[2]};
    for (size_t n = 0; n < count && st == CW_OK; n++)
        st = cw_mesh_transform(&meshes[n], map, err);
    return st;
}

cw_status cli_place_parts(const cli_placing *p, cli_mesh *m, cw_error *err)
{
    const size_t count = m->parts ? m->part_count : 1;
    double map[12], low[3], high[3];
    make_map(p, map);
    cw_status st = move_parts(m, count, map, err);
    if (st == CW_OK && p->pivot != CLI_PIVOT_FILE)
        st = move_to_pivot(p->pivot, m, count, err);
    if (st != CW_OK)
        return st;
    find_box(m, count, low, high);
    if (low[0] <= high[0])
        cli_say("%s: placed from %.6g %.6g %.6g to %.6g %.6g %.6g mm", m->path, low[0], low[1],
                low[2], high[0], high[1], high[2]);
    return CW_OK;
}

void cli_json_placing(cli_json *j, const cli_placing *p)
{
    static const char *const axes[] = {"x", "y", "z"};
    if (p->scale.count)
        cli_json_numbers(j, "scale", p->scale.value, p->scale.count);
    if (p->mirror)
        cli_json_text(j, "mirror", axes[p->mirror - 1]);
    if (p->rotation.count)
        cli_json_text(j, "rotate", p->rotation.text);
    cli_json_pivot(j, p->pivot);
}

void cli_json_pivot(cli_json *j, int pivot)
{
    if (pivot != CLI_PIVOT_FILE)
        cli_json_text(j, "pivot", pivots[pivot]);
}
