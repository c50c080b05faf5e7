/* Reads Draco files. The library decodes them in a sandboxed process, which keeps the result
 * and hands it over piece by piece. Only the result tells how large it is. */
#include "core/base/memory.h"
#include "core/base/sandbox.h"
#include "core/base/status.h"
#include "core/mesh/mesh.h"
#include "formats/codec/draco_wrap.h"
#include "formats/draco/drc_format.h"

#include <math.h>
#include <string.h>

/* An upper bound of Draco's compression, far beyond all observed files; larger claims are
 * rejected. */
enum { MAX_GAIN = 1024, WINDOW = 4 << 20 };

typedef enum operation {
    DECODE,
    COPY_POSITIONS,
    COPY_NORMALS,
    COPY_COLORS,
    COPY_TRIANGLES
} operation;

/* A request to the child. The file lies at the start of the shared memory; copied arrays
 * replace it. */
typedef struct request {
    operation op;
    uint64_t max;         /* DECODE: vertices or triangles */
    uint64_t from, count; /* bytes of an array; DECODE: of the file */
} request;

typedef struct counts {
    uint64_t vertices, triangles;
    uint8_t normals, colors;
    char comment[CWI_DRACO_COMMENT];
} counts;

/* The child's state. */
typedef struct decoder {
    const cwi_draco_functions *draco;
    cwi_arrays arrays;
} decoder;

bool cwi_drc_sniff(const unsigned char *head, size_t size, uint64_t file_size)
{
    (void)file_size;
    return size >= 5 && memcmp(head, "DRACO", 5) == 0;
}

/* --- in the child ------------------------------------------------------------------------- */

static cw_status load_draco(void *state, cw_error *err)
{
    decoder *d = state;
    return cwi_draco_functions_load(&d->draco, err);
}

static cw_status decode_file(decoder *d, const request *r, void *shared, cw_error *err)
{
    cwi_arrays_free(&d->arrays);
    cw_status st =
        d->draco->decode(shared, (size_t)r->count, NULL, (size_t)r->max, NULL, &d->arrays, err);
    counts c = {.vertices = d->arrays.vertex_count,
                .triangles = d->arrays.triangle_count,
                .normals = d->arrays.normals != NULL,
                .colors = d->arrays.colors != NULL};
    memcpy(c.comment, d->arrays.comment, sizeof c.comment);
    if (st == CW_OK)
        memcpy(shared, &c, sizeof c);
    return st;
}

static cw_status answer_request(void *state, int fd, const void *bytes, void *shared,
                                cw_error *err)
{
    decoder *d = state;
    request r;
    (void)fd;
    memcpy(&r, bytes, sizeof r);
    const void *const arrays[] = {[COPY_POSITIONS] = d->arrays.positions,
                                  [COPY_NORMALS] = d->arrays.normals,
                                  [COPY_COLORS] = d->arrays.colors,
                                  [COPY_TRIANGLES] = d->arrays.triangles};
    if (r.op == DECODE)
        return decode_file(d, &r, shared, err);
    memcpy(shared, (const char *)arrays[r.op] + r.from, (size_t)r.count);
    return CW_OK;
}

/* --- in the parent ------------------------------------------------------------------------ */

static cw_status read_file(const cwi_mesh_input *in, cwi_sandbox *box, cw_error *err)
{
    char *to = box->shared;
    size_t got = 0;
    cw_status st = CW_OK;
    for (uint64_t at = 0; st == CW_OK && at < in->file.size; at += got) {
        st = cwi_progress(&in->desc.progress, "reading", (double)at / (double)in->file.size,
                          err);
        if (st == CW_OK)
            st = cwi_input_read_at(
                in->file.fd, at, to + at,
                (size_t)(in->file.size - at < WINDOW ? in->file.size - at : WINDOW), &got, err);
        if (st == CW_OK && got == 0)
            return cwi_fail(err, CW_ERR_IO, "the file became shorter while it was read");
    }
    return st;
}

static cw_status copy_array(cwi_sandbox *box, operation op, void *to, size_t bytes,
                            cw_error *err)
{
    cw_status st = CW_OK;
    for (size_t at = 0, n; at < bytes && st == CW_OK; at += n) {
        n = bytes - at < WINDOW ? bytes - at : WINDOW;
        const request r = {.op = op, .from = at, .count = n};
        st = cwi_sandbox_run(box, -1, &r, sizeof r, err);
        if (st == CW_OK)
            memcpy((char *)to + at, box->shared, n);
    }
    return st;
}

static cw_status check_counts(cwi_mesh_input *in, const counts *c, cw_error *err)
{
    if (c->vertices / MAX_GAIN > in->file.size || c->triangles / MAX_GAIN > in->file.size)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "%llu bytes cannot stand for %llu vertices and %llu triangles",
                        (unsigned long long)in->file.size, (unsigned long long)c->vertices,
                        (unsigned long long)c->triangles);
    cw_status st = cwi_mesh_limit_triangles(in, c->triangles, err);
    const uint64_t vertex = 12 + (c->normals ? 12u : 0) + (c->colors ? 4u : 0);
    return st == CW_OK ? cwi_mesh_take_bytes(in, vertex * c->vertices + 12 * c->triangles, err)
                       : st;
}

static cw_status check_arrays(const cw_mesh *m, cw_error *err)
{
    for (size_t i = 0; i < 3 * m->vertex_count; i++)
        if (!isfinite(m->positions[i]))
            return cwi_fail(err, CW_ERR_FORMAT,
                            "vertex %zu has a coordinate that is not finite", i / 3);
    for (size_t i = 0; i < 3 * m->triangle_count; i++)
        if (m->triangles[i] >= m->vertex_count)
            return cwi_fail(err, CW_ERR_FORMAT, "triangle %zu names vertex %u; there are %zu",
                            i / 3, m->triangles[i], m->vertex_count);
    return CW_OK;
}

/* Reads the comment: two lines, the second one in local files only. */
static void take_comment(char *text, cw_mesh *mesh, cw_mesh_file *metadata)
{
    char *second = strchr(text, '\n');
    bool ours = false;
    if (second)
        *second++ = '\0';
    cwi_take_comment(text, &ours, mesh, metadata);
    if (second)
        cwi_take_comment(second, &ours, mesh, metadata);
}

static cw_status take_mesh(cwi_mesh_input *in, cwi_sandbox *box, cw_mesh *mesh,
                           cw_mesh_file *metadata, cw_error *err)
{
    counts c;
    memcpy(&c, box->shared, sizeof c);
    c.comment[sizeof c.comment - 1] = '\0';
    cw_status st = check_counts(in, &c, err);
    if (st == CW_OK)
        st = cwi_mesh_alloc(mesh, (size_t)c.vertices, (size_t)c.triangles, c.normals, err);
    if (st == CW_OK)
        take_comment(c.comment, mesh, metadata);
    if (st == CW_OK && c.colors && !(mesh->colors = cwi_alloc_array(mesh->vertex_count, 4)))
        st = cwi_fail_memory(err);
    if (st == CW_OK)
        st = copy_array(box, COPY_POSITIONS, mesh->positions, 12 * mesh->vertex_count, err);
    if (st == CW_OK && mesh->normals)
        st = copy_array(box, COPY_NORMALS, mesh->normals, 12 * mesh->vertex_count, err);
    if (st == CW_OK && mesh->colors)
        st = copy_array(box, COPY_COLORS, mesh->colors, 4 * mesh->vertex_count, err);
    if (st == CW_OK)
        st = copy_array(box, COPY_TRIANGLES, mesh->triangles, 12 * mesh->triangle_count, err);
    return st == CW_OK ? check_arrays(mesh, err) : st;
}

cw_status cwi_drc_read(cwi_mesh_input *in, cw_mesh *mesh, cw_mesh_file *metadata, cw_error *err)
{
    decoder d = {0};
    cwi_sandbox box = {0};
    _Static_assert(sizeof(request) <= CWI_SANDBOX_REQUEST, "a request fits");
    cw_status st = cwi_mesh_take_bytes(in, in->file.size, err);
    const cwi_sandbox_desc desc = {.library = "Draco",
                                   .prepare = load_draco,
                                   .work = answer_request,
                                   .state = &d,
                                   .shared_bytes =
                                       in->file.size > WINDOW ? (size_t)in->file.size : WINDOW,
                                   .memory = in->desc.max_bytes,
                                   .timeout_s = in->desc.timeout_s,
                                   .inside = in->desc.no_sandbox};
    if (st == CW_OK)
        st = cwi_sandbox_open(&box, &desc, err);
    if (st != CW_OK)
        return st;
    const request r = {.op = DECODE,
                       .max = in->file.size > UINT32_MAX / MAX_GAIN ? UINT32_MAX
                                                                    : MAX_GAIN * in->file.size,
                       .count = in->file.size};
    box.progress = &in->desc.progress;
    st = read_file(in, &box, err);
    if (st == CW_OK)
        st = cwi_sandbox_run(&box, -1, &r, sizeof r, err);
    if (st == CW_OK)
        st = take_mesh(in, &box, mesh, metadata, err);
    in->bytes -= in->file.size < in->bytes ? in->file.size : in->bytes;
    cwi_sandbox_close(&box);
    cwi_arrays_free(&d.arrays);
    return st;
}
