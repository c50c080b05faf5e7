/* Who does which work: a row of a table each. */
#include "cli/bench/bench.h"

#include "cli/framework/console.h"
#include "cli/inputs/extract_surface.h"
#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/codec/meshopt_wrap.h"

#include <cubewright/formats.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

typedef struct actions {
    cw_status (*prepare)(cli_bench *b, const cli_bench_kind *kind, cw_error *err);
    cw_status (*once)(cli_bench *b, const cli_bench_kind *kind, cli_spent *spent,
                      cw_error *err);
    cw_status (*take)(cli_bench *b, const cli_bench_kind *kind, cw_mesh *mesh, size_t *bytes,
                      cw_error *err);
} actions;

enum { OURS = -1 };

struct cli_bench_kind {
    cli_bench_work work;
    int peer; /* cli_peer_id, or OURS */
    const char *setting;
    const actions *does;
    const char *against; /* the setting of ours that a peer's time is set beside */
    bool one_thread;     /* it has no more */
    bool cubic, no_normals;
    cw_compression compression;
};

/* --- ours --------------------------------------------------------------------------------- */

typedef struct stopwatch {
    cli_watch memory;
    double start;
} stopwatch;

static stopwatch start_watch(void)
{
    const cli_watch memory = cli_watch_memory();
    return (stopwatch){memory, cli_seconds()};
}

static cli_spent stop_watch(const stopwatch *w)
{
    const double seconds = cli_seconds() - w->start;
    return (cli_spent){seconds, cli_watched_bytes(&w->memory)};
}

static cw_status extract_surface(cli_bench *b, const cli_bench_kind *kind, cli_spent *spent,
                                 cw_error *err)
{
    const cw_extract_desc desc = {.isovalue = b->now->iso,
                                  .inside_is_low = b->now->inside_is_low,
                                  .leave_open = true,
                                  .cubic_placement = kind->cubic,
                                  .no_normals = kind->no_normals,
                                  .threads = b->threads};
    cw_extract_counts counts;
    cw_mesh_free(&b->made);
    const stopwatch watch = start_watch();
    cw_status st = cli_extract_surface(&b->volume, NULL, &desc, &b->made, &counts, err);
    *spent = stop_watch(&watch);
    return st;
}

static size_t target_of(const cli_bench *b)
{
    const size_t count = b->surface.triangle_count * CLI_BENCH_SHARE / 100;
    return count ? count : 1;
}

static cw_status simplify_surface(cli_bench *b, const cli_bench_kind *kind, cli_spent *spent,
                                  cw_error *err)
{
    const cw_simplify_desc desc = {
        .triangles = target_of(b),
        .threads = b->threads,
        .progress = cli_progress((double)b->surface.triangle_count / 1e6, "Mtriangle")};
    (void)kind;
    cw_mesh_free(&b->made);
    const stopwatch watch = start_watch();
    cw_status st = cw_simplify(&b->surface, &desc, &b->made, NULL, err);
    *spent = stop_watch(&watch);
    return st;
}

static cw_status take_made(cli_bench *b, const cli_bench_kind *kind, cw_mesh *mesh,
                           size_t *bytes, cw_error *err)
{
    (void)kind;
    (void)err;
    *bytes = 0;
    *mesh = b->made;
    b->made = (cw_mesh){0};
    return CW_OK;
}

/* In static memory, until the next call. */
static const char *path_of(const cli_bench *b, const char *name)
{
    static char path[4200];
    snprintf(path, sizeof path, "%s/%s", b->folder, name);
    return path;
}

static size_t size_of(const cli_bench *b, const char *name)
{
    struct stat facts;
    return stat(path_of(b, name), &facts) == 0 ? (size_t)facts.st_size : 0;
}

static cw_status compress_mesh(cli_bench *b, const cli_bench_kind *kind, cli_spent *spent,
                               cw_error *err)
{
    const cw_write_desc desc = {
        .compression = kind->compression,
        .bits = kind->compression ? CLI_BENCH_BITS : 0,
        .progress = cli_progress((double)b->surface.triangle_count / 1e6, "Mtriangle")};
    const stopwatch watch = start_watch();
    cw_status st = cw_mesh_write(path_of(b, "mesh.glb"), &b->surface, &desc, err);
    *spent = stop_watch(&watch);
    return st;
}

static cw_status take_written(cli_bench *b, const cli_bench_kind *kind, cw_mesh *mesh,
                              size_t *bytes, cw_error *err)
{
    (void)kind;
    *bytes = size_of(b, "mesh.glb");
    return cw_mesh_read(path_of(b, "mesh.glb"), NULL, mesh, NULL, err);
}

/* --- peers with a child ------------------------------------------------------------------- */

static cw_status prepare_volume(cli_bench *b, const cli_bench_kind *kind, cw_error *err)
{
    return cli_peer_prepare_volume(&b->peers, &b->peers.of[kind->peer], &b->volume.view,
                                   b->now->iso, b->now->inside_is_low, err);
}

static cw_status prepare_mesh(cli_bench *b, const cli_bench_kind *kind, cw_error *err)
{
    return cli_peer_prepare_mesh(&b->peers, &b->peers.of[kind->peer], &b->surface, target_of(b),
                                 err);
}

static cw_status run_child(cli_bench *b, const cli_bench_kind *kind, cli_spent *spent,
                           cw_error *err)
{
    return cli_peer_run(&b->peers.of[kind->peer], spent, err);
}

static cw_status take_extracted(cli_bench *b, const cli_bench_kind *kind, cw_mesh *mesh,
                                size_t *bytes, cw_error *err)
{
    *bytes = 0;
    return cli_peer_take(&b->peers, &b->peers.of[kind->peer], &b->volume.view, mesh, err);
}

static cw_status take_simplified(cli_bench *b, const cli_bench_kind *kind, cw_mesh *mesh,
                                 size_t *bytes, cw_error *err)
{
    *bytes = 0;
    cw_status st = cli_peer_take(&b->peers, &b->peers.of[kind->peer], NULL, mesh, err);
    memcpy(mesh->origin, b->surface.origin, sizeof mesh->origin);
    return st;
}

/* --- meshoptimizer ------------------------------------------------------------------------ */

static cw_status simplify_meshopt(cli_bench *b, const cli_bench_kind *kind, cli_spent *spent,
                                  cw_error *err)
{
    const cwi_meshopt_functions *meshopt;
    (void)kind;
    cw_mesh_free(&b->made);
    cw_status st = cwi_meshopt_functions_load(&meshopt, err);
    if (st != CW_OK)
        return st;
    const stopwatch watch = start_watch();
    b->made.triangles = cwi_alloc_array(3 * b->surface.triangle_count, sizeof(uint32_t));
    if (!b->made.triangles)
        return cwi_fail(err, CW_ERR_NO_MEMORY, "no memory for triangles");
    b->made.triangle_count = meshopt->simplify(&b->surface, target_of(b), b->made.triangles);
    *spent = stop_watch(&watch);
    return CW_OK;
}

static void *copy_of(const void *from, size_t bytes)
{
    void *to = cwi_alloc_array(bytes, 1);
    return to ? memcpy(to, from, bytes) : NULL;
}

/* Its triangles are between vertices of the input: the others are taken out. */
static cw_status take_meshopt(cli_bench *b, const cli_bench_kind *kind, cw_mesh *mesh,
                              size_t *bytes, cw_error *err)
{
    const cw_mesh *in = &b->surface;
    const size_t point_bytes = 3 * sizeof(float) * in->vertex_count;
    cw_status st = take_made(b, kind, mesh, bytes, err);
    if (mesh->triangle_count == 0)
        return cwi_fail(err, CW_ERR_BACKEND, "it left no triangles");
    memcpy(mesh->origin, in->origin, sizeof mesh->origin);
    mesh->vertex_count = in->vertex_count;
    mesh->positions = copy_of(in->positions, point_bytes);
    mesh->normals = copy_of(in->normals, point_bytes);
    if (!mesh->positions || !mesh->normals)
        return cwi_fail(err, CW_ERR_NO_MEMORY, "no memory for vertices");
    return st == CW_OK ? cw_mesh_drop_components(mesh, 0, NULL, NULL, err) : st;
}

/* --- draco_encoder ------------------------------------------------------------------------ */

static cw_status prepare_draco(cli_bench *b, const cli_bench_kind *kind, cw_error *err)
{
    const cw_write_desc desc = {.local = true};
    (void)kind;
    return cw_mesh_write(path_of(b, "mesh.ply"), &b->surface, &desc, err);
}

static cw_status run_to_end(const cli_bench *b, const char *const *argv, cw_error *err)
{
    cli_child child;
    cw_status st = cli_child_start(&child, argv, b->folder, b->limit_s, err);
    return st == CW_OK ? cli_child_wait(&child, err) : st;
}

/* With the bits of normals, and the level, of our own writing. */
static cw_status run_draco(cli_bench *b, const cli_bench_kind *kind, cli_spent *spent,
                           cw_error *err)
{
    char bits[16];
    snprintf(bits, sizeof bits, "%d", CLI_BENCH_BITS);
    const char *const argv[] = {b->peers.of[kind->peer].path,
                                "-i",
                                "mesh.ply",
                                "-o",
                                "mesh.drc",
                                "-qp",
                                bits,
                                "-qn",
                                "10",
                                "-cl",
                                "7",
                                NULL};
    remove(path_of(b, "mesh.drc"));
    const double start = cli_seconds();
    cw_status st = run_to_end(b, argv, err);
    *spent = (cli_spent){.seconds = cli_seconds() - start};
    return st;
}

static cw_status take_draco(cli_bench *b, const cli_bench_kind *kind, cw_mesh *mesh,
                            size_t *bytes, cw_error *err)
{
    char decoder[4096];
    const char *const argv[] = {decoder, "-i", "mesh.drc", "-o", "back.ply", NULL};
    (void)kind;
    *bytes = size_of(b, "mesh.drc");
    if (!*bytes)
        return cwi_fail(err, CW_ERR_BACKEND, "it wrote nothing");
    if (!cli_find_program("draco_decoder", 0, decoder, sizeof decoder))
        return cwi_fail(err, CW_ERR_BACKEND, "there is no draco_decoder to read what it wrote");
    remove(path_of(b, "back.ply"));
    cw_status st = run_to_end(b, argv, err);
    if (st == CW_OK)
        st = cw_mesh_read(path_of(b, "back.ply"), NULL, mesh, NULL, err);
    for (int a = 0; a < 3 && st == CW_OK; a++)
        mesh->origin[a] += b->surface.origin[a];
    return st;
}

/* --- the table ---------------------------------------------------------------------------- */

static const actions extracting = {NULL, extract_surface, take_made},
                     simplifying = {NULL, simplify_surface, take_made},
                     compressing = {NULL, compress_mesh, take_written},
                     child_extracts = {prepare_volume, run_child, take_extracted},
                     child_simplifies = {prepare_mesh, run_child, take_simplified},
                     meshopt_simplifies = {NULL, simplify_meshopt, take_meshopt},
                     draco_compresses = {prepare_draco, run_draco, take_draco};

static const cli_bench_kind kinds[] = {
    {CLI_BENCH_EXTRACTION, OURS, "linear", &extracting, .against = NULL},
    {CLI_BENCH_EXTRACTION, OURS, "cubic", &extracting, .cubic = true},
    {CLI_BENCH_EXTRACTION, OURS, "linear, no normals", &extracting, .no_normals = true},
    {CLI_BENCH_EXTRACTION, CLI_PEER_VTK, "vtkFlyingEdges3D", &child_extracts,
     .against = "linear"},
    {CLI_BENCH_EXTRACTION, CLI_PEER_SKIMAGE, "marching_cubes", &child_extracts,
     .against = "linear", .one_thread = true},
    {CLI_BENCH_EXTRACTION, CLI_PEER_OPENVDB, "volumeToMesh, no normals", &child_extracts,
     .against = "linear, no normals"},
    {CLI_BENCH_SIMPLIFICATION, OURS, "to 10 %", &simplifying, .against = NULL},
    {CLI_BENCH_SIMPLIFICATION, CLI_PEER_VTK, "vtkQuadricDecimation", &child_simplifies,
     .against = "to 10 %", .one_thread = true},
    {CLI_BENCH_SIMPLIFICATION, CLI_PEER_MESHOPT, "meshopt_simplify", &meshopt_simplifies,
     .against = "to 10 %", .one_thread = true},
    {CLI_BENCH_COMPRESSION, OURS, "none", &compressing, .against = NULL},
    {CLI_BENCH_COMPRESSION, OURS, "quantize, 14 bits", &compressing,
     .compression = CW_COMPRESS_QUANTIZE},
    {CLI_BENCH_COMPRESSION, OURS, "meshopt, 14 bits", &compressing,
     .compression = CW_COMPRESS_MESHOPT},
    {CLI_BENCH_COMPRESSION, OURS, "draco, 14 bits", &compressing,
     .compression = CW_COMPRESS_DRACO},
    {CLI_BENCH_COMPRESSION, CLI_PEER_DRACO, "-qp 14 -qn 10 -cl 7", &draco_compresses,
     .against = "draco, 14 bits", .one_thread = true},
};

static void plan_peer(const cli_peer *peer, cli_bench_row *row)
{
    row->is_peer = true;
    row->who = peer->name;
    if (peer->state == CLI_PEER_READY)
        return;
    row->status = peer->state == CLI_PEER_MISSING ? CLI_BENCH_MISSING : CLI_BENCH_FAILED;
    if (peer->state == CLI_PEER_MISSING)
        snprintf(row->why, sizeof row->why, "%s: Debian's package %s brings it", peer->why,
                 peer->package);
    else
        snprintf(row->why, sizeof row->why, "%s", peer->why);
}

void cli_bench_plan(const cli_bench *b, cli_bench_case *c)
{
    for (size_t n = 0; n < sizeof kinds / sizeof *kinds; n++) {
        const cli_bench_kind *kind = &kinds[n];
        if (kind->peer != OURS && !b->with_peers)
            continue;
        cli_bench_row *row = &c->rows[c->row_count++];
        *row = (cli_bench_row){.kind = kind,
                               .work = kind->work,
                               .who = "cubewright",
                               .setting = kind->setting,
                               .against = kind->against,
                               .threads = kind->one_thread ? 1 : b->threads};
        if (kind->peer != OURS)
            plan_peer(&b->peers.of[kind->peer], row);
    }
}

cw_status cli_bench_prepare(cli_bench *b, const cli_bench_kind *kind, cw_error *err)
{
    return kind->does->prepare ? kind->does->prepare(b, kind, err) : CW_OK;
}

cw_status cli_bench_once(cli_bench *b, const cli_bench_kind *kind, cli_spent *spent,
                         cw_error *err)
{
    return kind->does->once(b, kind, spent, err);
}

cw_status cli_bench_take(cli_bench *b, const cli_bench_kind *kind, cw_mesh *mesh,
                         size_t *file_bytes, cw_error *err)
{
    *mesh = (cw_mesh){0};
    cw_status st = kind->does->take(b, kind, mesh, file_bytes, err);
    if (st != CW_OK)
        cw_mesh_free(mesh);
    return st;
}
