/* Finds the other libraries of the benchmark, exchanges files and commands with them, and
 * checks the meshes that they return. */
#define _GNU_SOURCE /* asprintf */
#include "cli/bench/bench_peers.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "core/volume/volume.h"
#include "formats/codec/meshopt_wrap.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

extern const char cli_python_peer[], cli_python_peer_vtk[], cli_python_peer_skimage[],
    cli_python_peer_openvdb[];

static const struct {
    const char *name, *package, *program;
} rows[CLI_PEER_COUNT] = {
    [CLI_PEER_VTK] = {"VTK", "python3-vtk9", cli_python_peer_vtk},
    [CLI_PEER_SKIMAGE] = {"scikit-image", "python3-skimage", cli_python_peer_skimage},
    [CLI_PEER_OPENVDB] = {"OpenVDB", "python3-openvdb", cli_python_peer_openvdb},
    [CLI_PEER_MESHOPT] = {"meshoptimizer", "libmeshoptimizer-dev", NULL},
    [CLI_PEER_DRACO] = {"draco_encoder", "draco", NULL},
};

static void set_state(cli_peer *peer, cli_peer_state state, const char *why)
{
    peer->state = state;
    snprintf(peer->why, sizeof peer->why, "%s", why);
}

/* --- starting ----------------------------------------------------------------------------- */

static cw_status start_python(const cli_peers *p, cli_peer *peer, const char *own, char *answer,
                              size_t room, cw_error *err)
{
    char threads[16], *text = NULL;
    snprintf(threads, sizeof threads, "%d", p->threads);
    if (asprintf(&text, "%s%s", cli_python_peer, own) < 0)
        return cwi_fail(err, CW_ERR_NO_MEMORY, "no memory for a program");
    const char *const argv[] = {peer->path, "-c", text, threads, NULL};
    cw_status st = cli_child_start(&peer->child, argv, p->folder, p->limit_s, err);
    free(text);
    return st == CW_OK ? cli_child_ask(&peer->child, NULL, answer, room, err) : st;
}

static bool is_version(const char *text)
{
    return *text && strlen(text) < sizeof((cli_peer *)0)->version &&
           text[strspn(text, "0123456789abcdefghijklmnopqrstuvwxyz.+-")] == '\0';
}

/* Of every python3 there is, the first that can: a Python of one's own lacks what
 * Debian's has. */
static cw_status find_python(cli_peers *p, cli_peer *peer, const char *own, cw_error *err)
{
    char answer[256], why[sizeof peer->why];
    set_state(peer, CLI_PEER_MISSING, "there is no python3");
    for (size_t n = 0; cli_find_program("python3", n, peer->path, sizeof peer->path); n++) {
        cw_status st = start_python(p, peer, own, answer, sizeof answer, err);
        if (st == CW_OK && strncmp(answer, "ready ", 6) == 0 && is_version(answer + 6)) {
            strcpy(peer->version, answer + 6);
            set_state(peer, CLI_PEER_READY, "");
            return CW_OK;
        }
        cli_child_stop(&peer->child);
        if (st == CW_ERR_CANCELLED)
            return st;
        if (st == CW_OK && strncmp(answer, "missing ", 8) == 0) {
            snprintf(why, sizeof why, "no python3 has its modules");
            set_state(peer, CLI_PEER_MISSING, why);
            continue;
        }
        snprintf(why, sizeof why, "%.200s",
                 st == CW_OK ? "its answer is not understood" : err->message);
        set_state(peer, CLI_PEER_FAILED, why);
        break;
    }
    return CW_OK;
}

static void find_meshopt(cli_peer *peer)
{
    const cwi_meshopt_functions *functions;
    cw_error why;
    if (cwi_meshopt_functions_load(&functions, &why) != CW_OK) {
        set_state(peer, CLI_PEER_MISSING, "this build is without it");
        return;
    }
    snprintf(peer->version, sizeof peer->version, "%d.%d", functions->version / 1000,
             functions->version / 10 % 100);
    set_state(peer, CLI_PEER_READY, "");
}

static void find_draco(cli_peer *peer)
{
    if (cli_find_program("draco_encoder", 0, peer->path, sizeof peer->path))
        set_state(peer, CLI_PEER_READY, "");
    else
        set_state(peer, CLI_PEER_MISSING, "there is no such command");
}

cw_status cli_peers_start(cli_peers *p, const char *folder, int threads, double limit_s,
                          cw_error *err)
{
    cw_status st = CW_OK;
    *p = (cli_peers){.folder = folder, .threads = threads, .limit_s = limit_s};
    for (int n = 0; n < CLI_PEER_COUNT && st == CW_OK; n++) {
        cli_peer *peer = &p->of[n];
        peer->name = rows[n].name;
        peer->package = rows[n].package;
        if (n == CLI_PEER_MESHOPT)
            find_meshopt(peer);
        else if (n == CLI_PEER_DRACO)
            find_draco(peer);
        else
            st = find_python(p, peer, rows[n].program, err);
    }
    return st;
}

void cli_peers_stop(cli_peers *p)
{
    for (int n = 0; n < CLI_PEER_COUNT; n++)
        cli_child_stop(&p->of[n].child);
}

/* After a failure a new one is tried: what broke it may have been the case. */
static cw_status restart_peer(const cli_peers *p, cli_peer *peer, cw_error *err)
{
    char answer[256];
    if (peer->child.pid)
        return CW_OK;
    cw_status st =
        start_python(p, peer, rows[peer - p->of].program, answer, sizeof answer, err);
    if (st == CW_OK && strncmp(answer, "ready ", 6) != 0) {
        cli_child_stop(&peer->child);
        return cwi_fail(err, CW_ERR_BACKEND, "it did not start again");
    }
    return st;
}

/* --- what they are given ------------------------------------------------------------------ */

static FILE *open_file(const cli_peers *p, const char *name, const char *mode)
{
    char path[4096];
    snprintf(path, sizeof path, "%s/%s", p->folder, name);
    return fopen(path, mode);
}

static cw_status close_file(FILE *f, bool good, cw_error *err)
{
    if (f && fclose(f) == 0 && good)
        return CW_OK;
    return cwi_fail(err, CW_ERR_OUTPUT, "the files that peers read cannot be written");
}

static bool put_row(FILE *f, const cw_volume *v, size_t j, size_t k)
{
    const size_t bytes = cw_type_size(v->type);
    if (v->stride[0] == (ptrdiff_t)bytes)
        return fwrite(cwi_voxel_address(v, 0, j, k), bytes, v->dim[0], f) == v->dim[0];
    for (size_t i = 0; i < v->dim[0]; i++)
        if (fwrite(cwi_voxel_address(v, i, j, k), bytes, 1, f) != 1)
            return false;
    return true;
}

cw_status cli_peers_put_volume(const cli_peers *p, const cw_volume *volume, cw_error *err)
{
    cw_volume v;
    cw_status st = cw_volume_resolve(volume, &v, err);
    if (st != CW_OK)
        return st;
    FILE *f = open_file(p, "volume", "wb");
    bool good = f;
    for (size_t k = 0; k < v.dim[2] && good; k++)
        for (size_t j = 0; j < v.dim[1] && good; j++)
            good = put_row(f, &v, j, k);
    return close_file(f, good, err);
}

cw_status cli_peers_put_mesh(const cli_peers *p, const cw_mesh *mesh, cw_error *err)
{
    FILE *f = open_file(p, "mesh", "wb");
    const size_t points = 3 * mesh->vertex_count, corners = 3 * mesh->triangle_count;
    const bool good = f && fwrite(mesh->positions, sizeof(float), points, f) == points &&
                      fwrite(mesh->triangles, sizeof(uint32_t), corners, f) == corners;
    return close_file(f, good, err);
}

/* --- what they are asked ------------------------------------------------------------------ */

/* The numbers behind "ok", as many as are expected. */
static cw_status ask_peer(cli_peer *peer, const char *line, double *numbers, size_t count,
                          cw_error *err)
{
    char answer[256];
    cw_status st = cli_child_ask(&peer->child, line, answer, sizeof answer, err);
    if (st != CW_OK)
        return st;
    const char *at = answer + 2;
    bool good = strncmp(answer, "ok", 2) == 0;
    for (size_t n = 0; n < count && good; n++)
        good = cwi_parse_double(&at, &numbers[n]) && isfinite(numbers[n]) && numbers[n] >= 0;
    if (good && *at == '\0')
        return CW_OK;
    cli_child_stop(&peer->child);
    return cwi_fail(err, CW_ERR_BACKEND, "its answer is not understood");
}

/* Returns a value for voxels outside the surface, in the file's numbers. */
static double outside_of(const cw_volume *v, double level, bool inside_is_low)
{
    const bool high = inside_is_low != (v->slope < 0);
    return level + (high ? 1 : -1) * fmax(1, fabs(level));
}

cw_status cli_peer_prepare_volume(cli_peers *p, cli_peer *peer, const cw_volume *volume,
                                  double iso, bool inside_is_low, cw_error *err)
{
    static const char *const kinds[CW_TYPE_COUNT] = {"u1", "i1", "u2", "i2",
                                                     "u4", "i4", "f4", "f8"};
    char line[512];
    double mm[3];
    cw_volume v;
    cw_status st = restart_peer(p, peer, err);
    if (st == CW_OK)
        st = cw_volume_resolve(volume, &v, err);
    if (st != CW_OK)
        return st;
    const double level = (iso - v.intercept) / v.slope;
    cw_volume_spacing(&v, mm);
    snprintf(line, sizeof line, "extract %s %zu %zu %zu %.17g %.17g %.17g %.17g %.17g",
             kinds[v.type], v.dim[0], v.dim[1], v.dim[2], mm[0], mm[1], mm[2], level,
             outside_of(&v, level, inside_is_low));
    return ask_peer(peer, line, NULL, 0, err);
}

cw_status cli_peer_prepare_mesh(cli_peers *p, cli_peer *peer, const cw_mesh *mesh,
                                size_t target, cw_error *err)
{
    char line[128];
    cw_status st = restart_peer(p, peer, err);
    snprintf(line, sizeof line, "simplify %zu %zu %zu", mesh->vertex_count,
             mesh->triangle_count, target);
    return st == CW_OK ? ask_peer(peer, line, NULL, 0, err) : st;
}

cw_status cli_peer_run(cli_peer *peer, cli_spent *spent, cw_error *err)
{
    double numbers[2] = {0};
    cw_status st = ask_peer(peer, "run", numbers, 2, err);
    *spent = (cli_spent){numbers[0], numbers[1] < 1e18 ? (size_t)numbers[1] : 0};
    return st;
}

/* --- what they give back ------------------------------------------------------------------ */

static bool read_floats(FILE *f, size_t count, float **out)
{
    *out = cwi_alloc_array(count, sizeof **out);
    return *out && fread(*out, sizeof **out, count, f) == count;
}

/* Reads the mesh of a peer. The sizes are untrusted input: the file must have exactly the
 * bytes that they need. */
static cw_status read_result(const cli_peers *p, const double n[3], cw_mesh *mesh,
                             cw_error *err)
{
    struct stat facts;
    const double bytes = 12 * (n[0] * (n[2] > 0 ? 2 : 1) + n[1]);
    FILE *f = open_file(p, "result", "rb");
    bool good = f && fstat(fileno(f), &facts) == 0 && (double)facts.st_size == bytes &&
                n[0] < UINT32_MAX && n[0] == floor(n[0]) && n[1] == floor(n[1]);
    if (good && n[1] < 1) {
        fclose(f);
        return cwi_fail(err, CW_ERR_BACKEND, "it made no triangles");
    }
    if (good) {
        mesh->vertex_count = (size_t)n[0];
        mesh->triangle_count = (size_t)n[1];
        const size_t points = 3 * mesh->vertex_count, corners = 3 * mesh->triangle_count;
        mesh->triangles = cwi_alloc_array(corners, sizeof *mesh->triangles);
        good = mesh->triangles && read_floats(f, points, &mesh->positions) &&
               (n[2] == 0 || read_floats(f, points, &mesh->normals)) &&
               fread(mesh->triangles, sizeof *mesh->triangles, corners, f) == corners;
    }
    if (f)
        fclose(f);
    if (!good || cw_mesh_check(mesh, NULL) != CW_OK)
        return cwi_fail(err, CW_ERR_BACKEND, "its output is not a mesh");
    return CW_OK;
}

/* From mm along the volume's axes into its frame. */
static void rotate_to_world(double m[3][3], float *p)
{
    const double from[3] = {p[0], p[1], p[2]};
    for (int a = 0; a < 3; a++)
        p[a] = (float)(m[a][0] * from[0] + m[a][1] * from[1] + m[a][2] * from[2]);
}

static void place_in_world(cw_mesh *mesh, const cw_volume *v)
{
    double mm[3], m[3][3];
    cw_volume_spacing(v, mm);
    for (int a = 0; a < 3; a++) {
        mesh->origin[a] = v->affine[a][3];
        for (int b = 0; b < 3; b++)
            m[a][b] = v->affine[a][b] / mm[b];
    }
    for (size_t n = 0; n < mesh->vertex_count; n++) {
        rotate_to_world(m, mesh->positions + 3 * n);
        if (mesh->normals)
            rotate_to_world(m, mesh->normals + 3 * n);
    }
}

cw_status cli_peer_take(cli_peers *p, cli_peer *peer, const cw_volume *placed, cw_mesh *mesh,
                        cw_error *err)
{
    double n[3];
    cw_volume v;
    cw_status st = ask_peer(peer, "save", n, 3, err);
    *mesh = (cw_mesh){0};
    if (st == CW_OK)
        st = read_result(p, n, mesh, err);
    if (st == CW_OK && placed)
        st = cw_volume_resolve(placed, &v, err);
    if (st == CW_OK && placed)
        place_in_world(mesh, &v);
    if (st != CW_OK)
        cw_mesh_free(mesh);
    return st;
}
