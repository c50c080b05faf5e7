/* Converts points between LPS millimetres and a file's unit and frame, and parses the names of
 * both. */
#include "formats/mesh/mesh_axes.h"

#include "core/base/status.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Makes the turn to a file's axes. RAS is half a turn about z. Y up is (x, y, z) to (x, z, -y),
 * so that z points up along y. Neither mirrors, so windings stay. */
cwi_turn cwi_turn_to(const cw_axes *axes)
{
    const double ras = axes->ras ? -1 : 1;
    cwi_turn t = {.from = {0, 1, 2}, .sign = {ras, ras, 1}};
    if (axes->y_up)
        t = (cwi_turn){.from = {0, 2, 1}, .sign = {ras, 1, -ras}};
    const double mm = cw_unit_mm(axes->unit);
    t.times = mm < 1 ? rint(1 / mm) : 1;
    t.over = mm < 1 ? 1 : mm;
    return t;
}

void cwi_turn_point(const cwi_turn *turn, const double world[3], double file[3])
{
    for (int a = 0; a < 3; a++)
        file[a] = cwi_turn_coordinate(turn, a, world[turn->from[a]]);
}

void cwi_print_axes(const cw_axes *axes, char text[CWI_AXES_BYTES])
{
    snprintf(text, CWI_AXES_BYTES, "%s, %s%s", axes->ras ? "RAS" : "LPS",
             cw_unit_name(axes->unit), axes->y_up ? ", Y up" : "");
}

/* Moves *text behind a word, if it is there and ends there; else returns false. */
static bool skip_word(const char **text, const char *word)
{
    const size_t length = strlen(word);
    const bool same = strncmp(*text, word, length) == 0 &&
                      (!(*text)[length] || strchr(" ,\t\r\n", (*text)[length]));
    *text += same ? length : 0;
    return same;
}

bool cwi_parse_unit(const char **text, cw_mesh_file *metadata)
{
    for (int u = 0; u < CW_UNIT_COUNT; u++)
        if (skip_word(text, cw_unit_name((cw_unit)u))) {
            metadata->axes.unit = (cw_unit)u;
            metadata->known |= CW_KNOWN_UNIT;
            return true;
        }
    return false;
}

bool cwi_parse_frame(const char **text, cw_mesh_file *metadata)
{
    const bool ras = skip_word(text, "RAS");
    if (!ras && !skip_word(text, "LPS"))
        return false;
    metadata->axes.ras = ras;
    metadata->known |= CW_KNOWN_FRAME;
    return true;
}

bool cwi_parse_axes(const char **text, cw_mesh_file *metadata)
{
    const cw_mesh_file before = *metadata;
    const char *at = *text;
    bool ok = cwi_parse_frame(&at, metadata) && strncmp(at, ", ", 2) == 0;
    at += ok ? 2 : 0;
    ok = ok && cwi_parse_unit(&at, metadata);
    if (!ok) {
        *metadata = before;
        return false;
    }
    *text = at;
    at += strncmp(at, ", ", 2) == 0 ? 2 : 0;
    metadata->axes.y_up = skip_word(&at, "Y up");
    if (metadata->axes.y_up)
        *text = at;
    return true;
}

/* Converts a point of the file to the world's coordinates. */
static void turn_back(const cwi_turn *t, const double file[3], double world[3])
{
    for (int a = 0; a < 3; a++)
        world[t->from[a]] = t->sign[a] * file[a] * t->over / t->times + 0.0;
}

static bool turn_floats(const cwi_turn *t, float *points, size_t count)
{
    bool finite = true;
    for (size_t i = 0; i < count; i++) {
        double file[3], world[3];
        for (size_t a = 0; a < 3; a++)
            file[a] = (double)points[3 * i + a];
        turn_back(t, file, world);
        for (size_t a = 0; a < 3; a++) {
            points[3 * i + a] = (float)world[a];
            finite = finite && isfinite(points[3 * i + a]);
        }
    }
    return finite;
}

cw_status cwi_turn_back(cw_mesh *mesh, const cw_axes *axes, cw_error *err)
{
    cwi_turn t = cwi_turn_to(axes);
    const double file[3] = {mesh->origin[0], mesh->origin[1], mesh->origin[2]};
    if (axes->unit == CW_UNIT_MM && !axes->ras && !axes->y_up)
        return CW_OK;
    turn_back(&t, file, mesh->origin);
    bool ok = turn_floats(&t, mesh->positions, mesh->vertex_count);
    for (int a = 0; a < 3; a++)
        ok = ok && isfinite(mesh->origin[a]);
    if (!ok)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "its unit is '%s'; single precision cannot hold its coordinates in mm",
                        cw_unit_name(axes->unit));
    t.times = t.over = 1;
    if (mesh->normals)
        turn_floats(&t, mesh->normals, mesh->vertex_count);
    return CW_OK;
}
