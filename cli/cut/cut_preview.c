/* Draws pieces pulled apart: one mesh of all, with colours, seen from a corner. */
#include "cli/cut/cut_preview.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/box.h"
#include "core/geometry/vec3.h"
#include "core/mesh/mesh.h"

#include <cubewright/color.h>
#include <cubewright/picture.h>
#include <cubewright/render.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Colours of pieces, one after the other, sRGB; then those of sections, dowels and frames. */
static const uint8_t piece_colors[6][3] = {{86, 140, 196},  {230, 159, 74},  {104, 176, 116},
                                           {204, 121, 167}, {140, 128, 200}, {214, 196, 96}};
static const uint8_t dowel_color[3] = {120, 86, 58}, frame_color[3] = {200, 60, 50},
                     section_color[3] = {232, 228, 220};

/* Distance between pieces by the diagonal of all; thickness of frames by the same. */
static const double APART = 0.12, FRAME = 0.004;

/* A mesh without common vertices: three for each triangle, so that each has its colour. */
typedef struct preview_mesh {
    cw_mesh mesh;
    double low[3], high[3];
} preview_mesh;

static void add_triangle(preview_mesh *p, double corners[3][3], const uint8_t color[3])
{
    cw_mesh *m = &p->mesh;
    for (size_t k = 0; k < 3; k++) {
        const size_t v = m->vertex_count++;
        for (size_t a = 0; a < 3; a++)
            m->positions[3 * v + a] = (float)(corners[k][a] - m->origin[a]);
        memcpy(m->colors + 4 * v, color, 3);
        m->colors[4 * v + 3] = 255;
        m->triangles[3 * m->triangle_count + k] = (uint32_t)v;
        cwi_box_add(p->low, p->high, corners[k]);
    }
    m->triangle_count++;
}

/* Adds a piece, moved; sections are paler, so that pegs stand out. */
static void add_piece(preview_mesh *p, const cw_piece *piece, const uint8_t color[3],
                      const double by[3])
{
    const cw_mesh *m = &piece->mesh;
    const cw_attribute *a = cw_mesh_attribute_find(m, CW_SECTION_ATTRIBUTE);
    for (size_t t = 0; t < m->triangle_count; t++) {
        double x[3][3];
        for (size_t k = 0; k < 3; k++)
            for (size_t c = 0; c < 3; c++)
                x[k][c] = m->origin[c] +
                          (double)m->positions[3 * (size_t)m->triangles[3 * t + k] + c] + by[c];
        add_triangle(p, x, a && ((const uint32_t *)a->data)[t] ? section_color : color);
    }
}

/* Adds a bar between two points, as thick as wide. */
static void add_bar(preview_mesh *p, const double from[3], const double to[3],
                    const double side[3], const double up[3], double thick)
{
    static const int faces[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6},
                                     {0, 1, 4}, {1, 5, 4}, {2, 6, 3}, {3, 6, 7},
                                     {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    double corners[8][3];
    for (int n = 0; n < 8; n++) {
        cwi_add_scaled(n & 4 ? to : from, n & 1 ? thick : -thick, side, corners[n]);
        cwi_add_scaled(corners[n], n & 2 ? thick : -thick, up, corners[n]);
    }
    for (int n = 0; n < 12; n++) {
        double x[3][3];
        for (int k = 0; k < 3; k++)
            memcpy(x[k], corners[faces[n][k]], sizeof x[k]);
        add_triangle(p, x, frame_color);
    }
}

/* Adds a frame in a plane around the box of all pieces. low, high: that box */
static void add_frame(preview_mesh *p, const double point[3], const double normal[3],
                      const double low[3], const double high[3], double thick)
{
    double axes[2][3], range[2][2] = {{INFINITY, -INFINITY}, {INFINITY, -INFINITY}},
                       next[3] = {0};
    next[(cwi_longest_axis(normal) + 1) % 3] = 1;
    cwi_cross(normal, next, axes[1]);
    cwi_normalise(axes[1]);
    cwi_cross(axes[1], normal, axes[0]);
    for (int n = 0; n < 8; n++) {
        double x[3];
        for (int a = 0; a < 3; a++)
            x[a] = (n >> a & 1 ? high[a] : low[a]) - point[a];
        for (int k = 0; k < 2; k++) {
            range[k][0] = fmin(range[k][0], cwi_dot(x, axes[k]) - 6 * thick);
            range[k][1] = fmax(range[k][1], cwi_dot(x, axes[k]) + 6 * thick);
        }
    }
    for (int n = 0; n < 4; n++) {
        const int along = n / 2, other = 1 - along;
        double from[3], to[3];
        cwi_add_scaled(point, range[other][n % 2], axes[other], from);
        cwi_add_scaled(from, range[along][1], axes[along], to);
        cwi_add_scaled(from, range[along][0], axes[along], from);
        add_bar(p, from, to, axes[other], normal, thick);
    }
}

/* --- pulled apart ------------------------------------------------------------------------- */

/* Returns where a plane is along its normal, of length 1 then, and a point of it. low, high: the box of the whole */
static void find_plane(const cw_cut_desc *d, const double low[3], const double high[3],
                       double normal[3], double point[3])
{
    double offset = 0;
    memcpy(normal, d->normal, 3 * sizeof *normal);
    cwi_normalise(normal);
    for (int a = 0; a < 3; a++) {
        const double at =
            d->point_is_percent ? low[a] + (high[a] - low[a]) * d->point[a] / 100 : d->point[a];
        point[a] = (low[a] + high[a]) / 2;
        offset += normal[a] == 0 ? 0 : normal[a] * (at - point[a]);
    }
    cwi_add_scaled(point, offset, normal, point);
}

/* Adds to the movement of each piece half the distance between pieces, away from a plane; a dowel stays in the
 * middle of its own. */
static void pull_apart(const cw_pieces *pieces, const double point[3], const double normal[3],
                       double gap, double (*by)[3])
{
    for (size_t n = 0; n < pieces->count; n++) {
        double low[3], high[3], middle[3];
        cw_mesh_bounds(&pieces->pieces[n].mesh, low, high);
        cwi_midpoint(low, high, middle);
        cwi_sub(middle, point, middle);
        const double side = cwi_dot(middle, normal);
        const double reach = cwi_box_diagonal(low, high) * 1e-3;
        cwi_add_scaled(by[n],
                       side > reach    ? gap / 2
                       : side < -reach ? -gap / 2
                                       : 0,
                       normal, by[n]);
    }
}

static cw_status alloc_preview(const cw_pieces *pieces, size_t planes, preview_mesh *p,
                               double low[3], double high[3], cw_error *err)
{
    size_t triangles = 48 * planes;
    cwi_box_clear(low, high);
    for (size_t n = 0; n < pieces->count; n++) {
        double l[3], h[3];
        triangles += pieces->pieces[n].mesh.triangle_count;
        cw_mesh_bounds(&pieces->pieces[n].mesh, l, h);
        cwi_box_join(low, high, l, h);
    }
    const cw_status st = cwi_mesh_alloc(&p->mesh, 3 * triangles, triangles, false, err);
    if (st != CW_OK)
        return st;
    p->mesh.vertex_count = p->mesh.triangle_count = 0;
    p->mesh.colors = cwi_alloc_array(3 * triangles, 4);
    cwi_box_clear(p->low, p->high);
    cwi_midpoint(low, high, p->mesh.origin);
    return p->mesh.colors ? CW_OK : cwi_fail_memory(err);
}

static cw_status build_preview(const cw_pieces *pieces, const cw_cut_desc *planes, size_t count,
                               preview_mesh *p, cw_error *err)
{
    double low[3], high[3], longest = 0;
    size_t solids = 0;
    cw_status st = alloc_preview(pieces, count, p, low, high, err);
    double(*by)[3] = cwi_alloc_zeroed(pieces->count, sizeof *by);
    if (st == CW_OK && !by)
        st = cwi_fail_memory(err);
    for (size_t n = 0; n < pieces->peg_count; n++)
        longest = fmax(longest, pieces->pegs[n].length_mm);
    const double diagonal = cwi_box_diagonal(low, high);
    const double gap = fmax(APART * diagonal, 1.5 * longest);
    for (size_t k = 0; k < count && st == CW_OK; k++) {
        double normal[3], point[3];
        find_plane(&planes[k], low, high, normal, point);
        pull_apart(pieces, point, normal, gap, by);
    }
    for (size_t n = 0; n < pieces->count && st == CW_OK; n++) {
        const cw_piece *piece = &pieces->pieces[n];
        add_piece(p, piece, piece->is_dowel ? dowel_color : piece_colors[solids % 6], by[n]);
        solids += !piece->is_dowel;
    }
    double all_low[3], all_high[3];
    memcpy(all_low, p->low, sizeof all_low);
    memcpy(all_high, p->high, sizeof all_high);
    for (size_t k = 0; k < count && st == CW_OK; k++) {
        double normal[3], point[3];
        find_plane(&planes[k], low, high, normal, point);
        add_frame(p, point, normal, all_low, all_high, FRAME * diagonal);
    }
    cwi_free(by);
    return st;
}

cw_status cli_make_cut_preview(const cw_pieces *pieces, const cw_cut_desc *planes, size_t count,
                               cw_mesh *mesh, cw_error *err)
{
    preview_mesh p = {0};
    cw_status st = build_preview(pieces, planes, count, &p, err);
    if (st != CW_OK)
        cw_mesh_free(&p.mesh);
    *mesh = p.mesh;
    return st;
}

cw_status cli_write_cut_preview(const char *path, const cw_pieces *pieces,
                                const cw_cut_desc *planes, size_t count, int threads,
                                cw_error *err)
{
    cw_mesh mesh;
    cw_image image = {0};
    cw_render_mesh_desc desc = {
        .width = 1280, .height = 960, .samples = 3, .threads = threads, .same_inside = true};
    cw_status st = cli_make_cut_preview(pieces, planes, count, &mesh, err);
    cw_fit_desc fit = {.view = "front",
                       .aspect = (double)desc.width / (double)desc.height,
                       .fov_deg = 25,
                       .margin = 0.04,
                       .azimuth_deg = 32,
                       .elevation_deg = 24};
    if (st == CW_OK)
        cw_mesh_bounds(&mesh, fit.min, fit.max);
    if (st == CW_OK)
        st = cw_camera_fit(&fit, &desc.camera, err);
    if (st == CW_OK)
        st = cw_render_mesh(&mesh, &desc, &image, err);
    if (st == CW_OK)
        st = cw_image_write(path, &image, err);
    cw_image_free(&image);
    cw_mesh_free(&mesh);
    return st;
}
