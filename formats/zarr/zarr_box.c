/* Reads boxes of a Zarr array: decodes the chunks that meet a box, and copies their voxels. */
#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/base/thread_pool.h"
#include "formats/zarr/zarr_dialect.h"

#include <stdio.h>
#include <string.h>

/* The work of one call. */
typedef struct boxing {
    cwi_zarr *zarr;
    const cwi_zarr_box *box;
    char *to;
    size_t every[CWI_ROLE_COUNT];
    size_t strides[CWI_ROLE_COUNT];     /* of the result, in bytes */
    size_t first_chunk[CWI_ROLE_COUNT]; /* chunks that meet the box, along each axis */
    size_t chunk_count[CWI_ROLE_COUNT];
    void **scratch; /* a chunk for each thread */
    size_t failed;  /* the first chunk that failed; SIZE_MAX: none */
    cw_status status;
    cw_error why;
} boxing;

/* The part of a chunk that is in the box: voxels of the result, and their first in the chunk. */
typedef struct overlap {
    size_t from[CWI_ROLE_COUNT], count[CWI_ROLE_COUNT];
    size_t start[CWI_ROLE_COUNT];
    bool is_whole; /* the box has all voxels of the chunk */
} overlap;

static size_t find_chunk_size(const cwi_zarr *z, int role)
{
    return z->dimensions[role] < 0 ? 1 : z->array.inner[z->dimensions[role]];
}

/* Returns false if no wanted voxel is in the chunk. */
static bool find_overlap(const boxing *b, const size_t at[CWI_ROLE_COUNT], overlap *o)
{
    o->is_whole = true;
    for (int r = 0; r < CWI_ROLE_COUNT; r++) {
        const size_t chunk = find_chunk_size(b->zarr, r), size = b->zarr->sizes[r];
        const size_t low = at[r] * chunk, first = b->box->first[r], every = b->every[r];
        const size_t end = low + chunk < size ? low + chunk : size;
        const size_t box_end = first + b->box->count[r];
        const size_t stop = end < box_end ? end : box_end;
        o->is_whole &= first <= low && end <= box_end;
        o->from[r] = low > first ? (low - first - 1) / every + 1 : 0;
        if (first + o->from[r] * every >= stop)
            return false;
        o->count[r] = (stop - 1 - first) / every + 1 - o->from[r];
        o->start[r] = first + o->from[r] * every - low;
    }
    return true;
}

/* --- copying ------------------------------------------------------------------------------ */

static void copy_numbers(const char *from, size_t stride, size_t size, char *to, size_t count)
{
    if (stride == size) {
        memcpy(to, from, count * size);
        return;
    }
    for (size_t i = 0; size == 1 && i < count; i++)
        to[i] = from[i * stride];
    for (size_t i = 0; size == 2 && i < count; i++)
        ((uint16_t *)(void *)to)[i] = *(const uint16_t *)(const void *)(from + i * stride);
    for (size_t i = 0; size == 4 && i < count; i++)
        ((uint32_t *)(void *)to)[i] = *(const uint32_t *)(const void *)(from + i * stride);
    for (size_t i = 0; size == 8 && i < count; i++)
        ((uint64_t *)(void *)to)[i] = *(const uint64_t *)(const void *)(from + i * stride);
}

static cw_status fail_number(const cwi_zarr_array *a, const void *number, cw_error *err)
{
    cw_error why = {0};
    cw_status st = cwi_stored_fail(a->stored, a->type, number, &why);
    const char *folder = a->words->at_root ? "" : a->path;
    return cwi_fail(err, st, "%s%s%s: '%s' is %s, and %s", folder, *folder ? "/" : "",
                    a->words->file, a->words->type, a->type_name, why.message);
}

/* Copies the overlap of a chunk; its numbers all have one value where missing. */
static cw_status copy_overlap(const boxing *b, const overlap *o, const char *chunk,
                              bool missing, cw_error *err)
{
    const cwi_zarr_array *a = &b->zarr->array;
    const size_t size = cw_type_size(a->type), rows = o->count[CWI_AXIS_Y];
    size_t strides[CWI_ZARR_RANK], step[CWI_ROLE_COUNT] = {0}, at[CWI_ROLE_COUNT] = {0};
    size_t stride = a->stored_bytes, base = 0, to_base = 0;
    for (size_t n = a->rank; n > 0; n--) {
        strides[a->order[n - 1]] = missing ? 0 : stride;
        stride *= a->inner[a->order[n - 1]];
    }
    for (int r = 0; r < CWI_ROLE_COUNT; r++) {
        const size_t along = b->zarr->dimensions[r] < 0 ? 0 : strides[b->zarr->dimensions[r]];
        step[r] = along * b->every[r];
        base += along * o->start[r];
        to_base += o->from[r] * b->strides[r];
    }
    for (at[CWI_AXIS_STEP] = 0; at[CWI_AXIS_STEP] < o->count[CWI_AXIS_STEP];
         at[CWI_AXIS_STEP]++)
        for (at[CWI_AXIS_COMPONENT] = 0; at[CWI_AXIS_COMPONENT] < o->count[CWI_AXIS_COMPONENT];
             at[CWI_AXIS_COMPONENT]++)
            for (size_t n = 0; n < o->count[CWI_AXIS_Z] * rows; n++) {
                at[CWI_AXIS_Z] = n / rows;
                at[CWI_AXIS_Y] = n % rows;
                size_t from = base, to = to_base;
                for (int r = CWI_AXIS_Y; r < CWI_ROLE_COUNT; r++) {
                    from += at[r] * step[r];
                    to += at[r] * b->strides[r];
                }
                const size_t count = o->count[CWI_AXIS_X];
                if (!a->stored) {
                    copy_numbers(chunk + from, step[CWI_AXIS_X], size, b->to + to, count);
                    continue;
                }
                const size_t good = cwi_stored_convert(a->stored, a->type, chunk + from,
                                                       step[CWI_AXIS_X], count, b->to + to);
                if (good < count)
                    return fail_number(a, chunk + from + good * step[CWI_AXIS_X], err);
            }
    return CW_OK;
}

/* --- chunks that are kept ----------------------------------------------------------------- */

/* Returns the number of a chunk, from 0. Those of one place in z are neighbours. */
static uint64_t number_chunk(const cwi_zarr *z, const size_t at[CWI_ROLE_COUNT])
{
    static const int order[] = {CWI_AXIS_Z, CWI_AXIS_STEP, CWI_AXIS_COMPONENT, CWI_AXIS_Y,
                                CWI_AXIS_X};
    uint64_t number = 0;
    for (int n = 0; n < CWI_ROLE_COUNT; n++) {
        const int r = order[n];
        number = number * ((z->sizes[r] - 1) / find_chunk_size(z, r) + 1) + at[r];
    }
    return number;
}

/* Finds a kept chunk. It stays until the call ends. */
static const void *find_kept(cwi_zarr *z, uint64_t number)
{
    const void *found = NULL;
    if (!z->slot_count)
        return NULL;
    pthread_mutex_lock(&z->lock);
    cwi_zarr_slot *slot = &z->slots[number % z->slot_count];
    if (slot->key == number + 1) {
        slot->call = z->call;
        found = slot->bytes;
    }
    pthread_mutex_unlock(&z->lock);
    return found;
}

/* Gives up the chunks of rows that lie before a row, as slabs of rising z have passed them. Their
 * memory is for the next chunks. */
static void drop_rows(cwi_zarr *z, size_t row)
{
    for (size_t n = 0; n < z->slot_count; n++)
        if (z->slots[n].bytes && z->slots[n].row < row) {
            z->spare[z->spare_count++] = z->slots[n].bytes;
            z->slots[n] = (cwi_zarr_slot){0};
        }
}

/* Takes spare memory for a chunk, if there is any. */
static void take_spare(cwi_zarr *z, void **bytes)
{
    pthread_mutex_lock(&z->lock);
    if (!*bytes && z->spare_count > 0)
        *bytes = z->spare[--z->spare_count];
    pthread_mutex_unlock(&z->lock);
}

/* Keeps a chunk in place of one that this call did not use. The thread gets that one's memory. */
static void keep_chunk(cwi_zarr *z, uint64_t number, size_t row, void **bytes)
{
    if (!z->slot_count)
        return;
    pthread_mutex_lock(&z->lock);
    cwi_zarr_slot *slot = &z->slots[number % z->slot_count];
    if (slot->call != z->call) {
        void *before = slot->bytes;
        *slot =
            (cwi_zarr_slot){.key = number + 1, .row = row, .call = z->call, .bytes = *bytes};
        *bytes = before;
    }
    pthread_mutex_unlock(&z->lock);
}

/* --- the call ----------------------------------------------------------------------------- */

static cw_status read_chunk(boxing *b, const size_t at[CWI_ROLE_COUNT], cw_error *err)
{
    cwi_zarr *z = b->zarr;
    const cwi_zarr_array *a = &z->array;
    size_t chunk_index[CWI_ZARR_RANK] = {0};
    overlap o;
    bool missing = false;
    if (!find_overlap(b, at, &o))
        return CW_OK;
    const uint64_t number = number_chunk(z, at);
    const void *kept = find_kept(z, number);
    if (kept)
        return copy_overlap(b, &o, kept, false, err);
    void **scratch = &b->scratch[cwi_thread_number()];
    for (int r = 0; r < CWI_ROLE_COUNT; r++)
        if (z->dimensions[r] >= 0)
            chunk_index[z->dimensions[r]] = at[r];
    take_spare(z, scratch);
    cw_status st = z->dialect->load_chunk(z, chunk_index, scratch, &missing, err);
    if (st != CW_OK)
        return st;
    st = copy_overlap(b, &o, missing ? (const char *)&a->fill : *scratch, missing, err);
    if (st == CW_OK && !missing && !o.is_whole)
        keep_chunk(z, number, at[CWI_AXIS_Z], scratch);
    pthread_mutex_lock(&z->lock);
    z->decoded += !missing;
    pthread_mutex_unlock(&z->lock);
    return st;
}

/* Reads the k-th chunk. The first one that fails is reported, however many threads there are. */
static void read_nth_chunk(void *context, size_t k)
{
    boxing *b = context;
    size_t at[CWI_ROLE_COUNT], rest = k;
    cw_error why = {0};
    pthread_mutex_lock(&b->zarr->lock);
    const bool is_late = k > b->failed;
    pthread_mutex_unlock(&b->zarr->lock);
    if (is_late)
        return;
    for (int r = 0; r < CWI_ROLE_COUNT; r++) {
        at[r] = b->first_chunk[r] + rest % b->chunk_count[r];
        rest /= b->chunk_count[r];
    }
    const cw_status st = read_chunk(b, at, &why);
    if (st == CW_OK)
        return;
    pthread_mutex_lock(&b->zarr->lock);
    if (k < b->failed) {
        b->failed = k;
        b->status = st;
        b->why = why;
    }
    pthread_mutex_unlock(&b->zarr->lock);
}

/* Checks a box, and counts the chunks that meet it. */
static cw_status plan_box(boxing *b, size_t *chunks, cw_error *err)
{
    const cwi_zarr *z = b->zarr;
    size_t stride = cw_type_size(z->array.type);
    *chunks = 1;
    for (int r = 0; r < CWI_ROLE_COUNT; r++) {
        const size_t first = b->box->first[r], count = b->box->count[r];
        const size_t chunk = find_chunk_size(z, r);
        if (count < 1 || first >= z->sizes[r] || count > z->sizes[r] - first)
            return cwi_fail(err, CW_ERR_ARGUMENT,
                            "a box of %zu at %zu along axis %d; the array has %zu", count,
                            first, r, z->sizes[r]);
        b->every[r] = b->box->every[r] ? b->box->every[r] : 1;
        b->strides[r] = stride;
        b->first_chunk[r] = first / chunk;
        b->chunk_count[r] = (first + count - 1) / chunk - b->first_chunk[r] + 1;
        if (!cwi_size_mul(stride, (count - 1) / b->every[r] + 1, &stride) ||
            !cwi_size_mul(*chunks, b->chunk_count[r], chunks))
            return cwi_fail(err, CW_ERR_LIMIT, "a box of more chunks than can be counted");
    }
    return CW_OK;
}

cw_status cwi_zarr_read_box(cwi_zarr *z, const cwi_zarr_box *box, void *to,
                            const cw_progress *progress, cw_error *err)
{
    static const cw_progress silent = {0};
    const int threads = cwi_threads(z->threads);
    boxing b = {.zarr = z, .box = box, .to = to, .failed = SIZE_MAX};
    size_t chunks;
    cw_status st = plan_box(&b, &chunks, err);
    if (st != CW_OK)
        return st;
    b.scratch = cwi_alloc_zeroed((size_t)threads, sizeof *b.scratch);
    if (!b.scratch)
        return cwi_fail_memory(err);
    z->call++;
    drop_rows(z, b.first_chunk[CWI_AXIS_Z]);
    st = cwi_parallel_for(chunks, z->array.chunk_bytes / z->array.stored_bytes, z->threads,
                          progress ? progress : &silent, "reading", read_nth_chunk, &b, err);
    for (int n = 0; n < threads; n++)
        cwi_free(b.scratch[n]);
    cwi_free(b.scratch);
    if (st == CW_OK && b.status != CW_OK)
        return cwi_fail(err, b.status, "%s", b.why.message);
    return st;
}

cwi_zarr_box cwi_zarr_make_box(const cwi_zarr *z, const cw_box *box, size_t component,
                               size_t step)
{
    cwi_zarr_box made = {0};
    for (int r = 0; r < CWI_ROLE_COUNT; r++) {
        const bool is_space = r <= CWI_AXIS_Z;
        made.first[r] = is_space && box ? box->first[r] : 0;
        made.count[r] = !is_space ? 1 : box ? box->count[r] : z->sizes[r];
    }
    made.first[CWI_AXIS_COMPONENT] = component;
    made.first[CWI_AXIS_STEP] = step;
    return made;
}

void cwi_zarr_chunk_size(const cwi_zarr *z, size_t size[3])
{
    for (int a = 0; a < 3; a++)
        size[a] = find_chunk_size(z, a);
}

const cw_volume *cwi_zarr_shape(const cwi_zarr *z)
{
    return &z->shape;
}

uint64_t cwi_zarr_decoded(const cwi_zarr *z)
{
    return z->decoded;
}
