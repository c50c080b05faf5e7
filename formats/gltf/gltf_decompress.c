/* Decodes compressed views (meshopt) and primitives (Draco) of glTF in a sandboxed process. */
#include "formats/gltf/gltf_decompress.h"
#include "formats/codec/meshopt_wrap.h"

#include "core/base/memory.h"
#include "core/base/status.h"

#include <string.h>

/* Limits of compression, far beyond those observed in codecs; larger claims are rejected. */
enum { MAX_GAIN = 1024, MAX_STRIDE = 256, MIN_SHARED = 16 << 20 };

typedef enum job_kind { JOB_VERTICES, JOB_TRIANGLES, JOB_INDICES, JOB_DRACO } job_kind;

/* A job for the child. Compressed bytes lie at the start of the shared memory, results behind
 * them. */
typedef struct job {
    job_kind kind;
    int filter; /* of JOB_VERTICES: cwi_meshopt_filter */
    uint32_t stride;
    cwi_draco_ids ids;
    uint64_t packed, count, corners;
} job;

static size_t align_size(size_t size)
{
    return (size + 15) / 16 * 16;
}

/* --- in the child ------------------------------------------------------------------------- */

static cw_status unpack_view(const cwi_gltf_unpacker *u, const job *j, char *shared,
                             cw_error *err)
{
    char *to = shared + align_size(j->packed);
    if (j->kind == JOB_TRIANGLES)
        return u->meshopt->decode_triangles(to, j->count, j->stride, shared, j->packed, err);
    if (j->kind == JOB_INDICES)
        return u->meshopt->decode_indices(to, j->count, j->stride, shared, j->packed, err);
    cw_status st = u->meshopt->decode_vertices(to, j->count, j->stride, shared, j->packed, err);
    if (st == CW_OK && j->filter)
        u->meshopt->filter(to, j->count, j->stride, j->filter);
    return st;
}

static char *put_array(char *to, const void *array, size_t size)
{
    if (array)
        memcpy(to, array, size);
    return to + align_size(size);
}

static cw_status unpack_draco(const cwi_gltf_unpacker *u, const job *j, char *shared,
                              cw_error *err)
{
    cwi_arrays a = {0};
    char *to = shared + align_size(j->packed);
    const size_t max = j->count > j->corners ? j->count : j->corners;
    cw_status st = u->draco->decode(shared, j->packed, &j->ids, max, NULL, &a, err);
    if (st == CW_OK && (a.vertex_count != j->count || 3 * a.triangle_count != j->corners))
        st = cwi_fail(
            err, CW_ERR_FORMAT,
            "the Draco data have %zu vertices and %zu corners; their accessors say %llu "
            "and %llu",
            a.vertex_count, 3 * a.triangle_count, (unsigned long long)j->count,
            (unsigned long long)j->corners);
    if (st == CW_OK) {
        to = put_array(to, a.positions, 12 * a.vertex_count);
        to = put_array(to, a.triangles, 12 * a.triangle_count);
        to = put_array(to, a.normals, 12 * a.vertex_count);
        to = put_array(to, a.colors, 4 * a.vertex_count);
        put_array(to, a.texture, 8 * a.vertex_count);
    }
    cwi_arrays_free(&a);
    return st;
}

static cw_status work_on_job(void *state, int fd, const void *request, void *shared,
                             cw_error *err)
{
    job j;
    (void)fd;
    memcpy(&j, request, sizeof j);
    return j.kind == JOB_DRACO ? unpack_draco(state, &j, shared, err)
                               : unpack_view(state, &j, shared, err);
}

/* --- in the parent ------------------------------------------------------------------------ */

void cwi_gltf_unpacker_close(cwi_gltf_unpacker *u)
{
    cwi_sandbox_close(&u->box);
}

/* Starts a process that shares at least `bytes` bytes, with the libraries loaded so far. */
static cw_status start_sandbox(cwi_gltf_unpacker *u, size_t bytes, bool anew, cw_error *err)
{
    if (u->box.open && u->box.desc.shared_bytes >= bytes && !anew)
        return CW_OK;
    cwi_sandbox_close(&u->box);
    const cwi_sandbox_desc desc = {.library = "the decoder of compressed glTF",
                                   .work = work_on_job,
                                   .state = u,
                                   .shared_bytes = bytes > MIN_SHARED ? bytes : MIN_SHARED,
                                   .memory = u->desc->max_bytes,
                                   .timeout_s = u->desc->timeout_s,
                                   .inside = u->desc->no_sandbox};
    cw_status st = cwi_sandbox_open(&u->box, &desc, err);
    u->box.progress = &u->desc->progress;
    return st;
}

static cw_status run_job(cwi_gltf_unpacker *u, const job *j, const void *packed, size_t out,
                         bool anew, cw_error *err)
{
    _Static_assert(sizeof(job) <= CWI_SANDBOX_REQUEST, "a request holds a job");
    cw_status st = start_sandbox(u, align_size(j->packed) + out, anew, err);
    if (st != CW_OK)
        return st;
    memcpy(u->box.shared, packed, j->packed);
    return cwi_sandbox_run(&u->box, -1, j, sizeof *j, err);
}

static cw_status fail_claim(uint64_t claimed, uint64_t packed, cw_error *err)
{
    return cwi_fail(err, CW_ERR_FORMAT,
                    "%llu bytes of compressed data cannot stand for %llu elements",
                    (unsigned long long)packed, (unsigned long long)claimed);
}

static bool is_view(const cwi_gltf_view *v)
{
    const bool indices = v->packed_mode != CWI_GLTF_ATTRIBUTES;
    return indices ? (v->packed_stride == 2 || v->packed_stride == 4) &&
                         (v->packed_mode != CWI_GLTF_TRIANGLES || v->packed_count % 3 == 0)
                   : v->packed_stride > 0 && v->packed_stride <= MAX_STRIDE &&
                         v->packed_stride % 4 == 0;
}

cw_status cwi_gltf_unpack_view(cwi_gltf_unpacker *u, const cwi_gltf_view *v,
                               const unsigned char *packed, unsigned char **bytes,
                               cw_error *err)
{
    const bool anew = !u->meshopt;
    const job j = {.kind = v->packed_mode == CWI_GLTF_ATTRIBUTES  ? JOB_VERTICES
                           : v->packed_mode == CWI_GLTF_TRIANGLES ? JOB_TRIANGLES
                                                                  : JOB_INDICES,
                   .filter = v->packed_filter,
                   .stride = (uint32_t)v->packed_stride,
                   .packed = v->packed_bytes,
                   .count = v->packed_count};
    if (!is_view(v))
        return cwi_fail(
            err, CW_ERR_FORMAT,
            "EXT_meshopt_compression states a byteStride of %llu and a count of %llu",
            (unsigned long long)v->packed_stride, (unsigned long long)v->packed_count);
    if (v->packed_count / MAX_GAIN > v->packed_bytes)
        return fail_claim(v->packed_count, v->packed_bytes, err);
    const size_t size = (size_t)(v->packed_count * v->packed_stride);
    cw_status st = anew ? cwi_meshopt_functions_load(&u->meshopt, err) : CW_OK;
    if (st == CW_OK)
        st = run_job(u, &j, packed, size, anew, err);
    if (st != CW_OK)
        return st;
    *bytes = cwi_alloc_array(size, 1);
    if (!*bytes)
        return cwi_fail_memory(err);
    memcpy(*bytes, (char *)u->box.shared + align_size(j.packed), size);
    return CW_OK;
}

/* Copies an array out of the shared memory and advances; returns false when memory is out. */
static bool take_array(const char **from, void *array, size_t size)
{
    void *copy = cwi_alloc_array(size, 1);
    if (copy)
        memcpy(copy, *from, size);
    memcpy(array, &copy, sizeof copy);
    *from += align_size(size);
    return copy != NULL;
}

cw_status cwi_gltf_unpack_draco(cwi_gltf_unpacker *u, const cwi_draco_ids *ids,
                                const unsigned char *packed, size_t size, uint64_t vertices,
                                uint64_t corners, cwi_arrays *arrays, cw_error *err)
{
    const bool anew = !u->draco;
    const job j = {
        .kind = JOB_DRACO, .ids = *ids, .packed = size, .count = vertices, .corners = corners};
    if (vertices / MAX_GAIN > size || corners / MAX_GAIN > size || corners % 3)
        return fail_claim(vertices > corners ? vertices : corners, size, err);
    const size_t points = (size_t)vertices;
    cw_status st = anew ? cwi_draco_functions_load(&u->draco, err) : CW_OK;
    if (st == CW_OK)
        st = run_job(u, &j, packed,
                     5 * align_size(12 * points) + align_size(4 * (size_t)corners), anew, err);
    if (st != CW_OK)
        return st;
    const char *from = (const char *)u->box.shared + align_size(size);
    arrays->vertex_count = points;
    arrays->triangle_count = (size_t)corners / 3;
    bool good = take_array(&from, &arrays->positions, 12 * points) &&
                take_array(&from, &arrays->triangles, 4 * (size_t)corners);
    if (good && ids->normal >= 0)
        good = take_array(&from, &arrays->normals, 12 * points);
    else
        from += align_size(12 * points);
    if (good && ids->color >= 0)
        good = take_array(&from, &arrays->colors, 4 * points);
    else
        from += align_size(4 * points);
    if (good && ids->texture >= 0)
        good = take_array(&from, &arrays->texture, 8 * points);
    return good ? CW_OK : cwi_fail_memory(err);
}
