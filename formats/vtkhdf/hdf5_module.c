/* The module "hdf5": opens a VTKHDF file, and gives its facts and rows of its arrays. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/vtkhdf/hdf5_file.h"

#include <pthread.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { MAX_CACHE_BYTES = 512 << 20 };

hid_t cwi_hdf5_type(uint32_t number)
{
    const hid_t types[CWI_VTKHDF_NUMBERS] = {
        -1,
        H5T_NATIVE_INT8,
        H5T_NATIVE_UINT8,
        H5T_NATIVE_INT16,
        H5T_NATIVE_UINT16,
        H5T_NATIVE_INT32,
        H5T_NATIVE_UINT32,
        H5T_NATIVE_INT64,
        H5T_NATIVE_UINT64,
        H5T_NATIVE_FLOAT,
        H5T_NATIVE_DOUBLE,
    };
    return number < CWI_VTKHDF_NUMBERS ? types[number] : -1;
}

/* --- arrays ------------------------------------------------------------------------------- */

void cwi_hdf5_close_array(cwi_hdf5_file *f)
{
    if (f->dataset >= 0)
        H5Dclose(f->dataset);
    f->dataset = -1;
}

/* Returns the bytes of all chunks beside each other that a row has numbers of: rows that are read one
 * after another then decode each chunk once. 0: there are no chunks. */
static size_t find_cache_bytes(hid_t dataset, const cwi_vtkhdf_array *a)
{
    const hid_t list = H5Dget_create_plist(dataset);
    hsize_t chunk[H5S_MAX_RANK];
    uint64_t bytes = cwi_vtkhdf_number_bytes(a->number);
    if (H5Pget_layout(list) != H5D_CHUNKED ||
        H5Pget_chunk(list, H5S_MAX_RANK, chunk) != (int)a->rank)
        bytes = 0;
    for (uint32_t n = 0; n < a->rank && bytes; n++) {
        const uint64_t along = n ? (a->dim[n] + chunk[n] - 1) / chunk[n] * chunk[n] : chunk[0];
        if (__builtin_mul_overflow(bytes, along, &bytes) || bytes > MAX_CACHE_BYTES)
            bytes = MAX_CACHE_BYTES;
    }
    H5Pclose(list);
    return bytes;
}

cw_status cwi_hdf5_open_array(cwi_hdf5_file *f, uint32_t array, cw_error *err)
{
    const cwi_vtkhdf_array *a = &f->facts.arrays[array];
    const size_t SLOTS = 10007;
    if (f->dataset >= 0 && f->open_array == array)
        return CW_OK;
    cwi_hdf5_close_array(f);
    hid_t dataset = H5Dopen2(f->group, a->name, H5P_DEFAULT);
    const size_t bytes = dataset >= 0 ? find_cache_bytes(dataset, a) : 0;
    if (bytes) {
        const hid_t access = H5Pcreate(H5P_DATASET_ACCESS);
        H5Pset_chunk_cache(access, SLOTS, bytes, 1);
        H5Dclose(dataset);
        dataset = H5Dopen2(f->group, a->name, access);
        H5Pclose(access);
    }
    f->dataset = dataset;
    f->open_array = array;
    return dataset >= 0 ? CW_OK : cwi_hdf5_fail(a->name, err);
}

static cw_status read_block(cwi_hdf5_file *f, const cwi_vtkhdf_array *a, const hsize_t *start,
                            const hsize_t *count, void *to, cw_error *err)
{
    hsize_t numbers = 1;
    for (uint32_t n = 0; n < a->rank; n++)
        numbers *= count[n];
    const hid_t space = H5Dget_space(f->dataset), memory = H5Screate_simple(1, &numbers, NULL);
    const bool is_read =
        space >= 0 && memory >= 0 &&
        H5Sselect_hyperslab(space, H5S_SELECT_SET, start, NULL, count, NULL) >= 0 &&
        H5Dread(f->dataset, cwi_hdf5_type(a->number), memory, space, H5P_DEFAULT, to) >= 0;
    cw_status st = is_read ? CW_OK : cwi_hdf5_fail(a->name, err);
    if (memory >= 0)
        H5Sclose(memory);
    if (space >= 0)
        H5Sclose(space);
    return st;
}

/* Reads rows, which the slowest `rank` dimensions number. Each step takes the largest block that
 * starts at the next row, and has whole dimensions behind one. */
static cw_status read_rows(cwi_hdf5_file *f, const cwi_vtkhdf_array *a, uint64_t first,
                           uint64_t rows, size_t row_bytes, char *to, cw_error *err)
{
    const uint32_t rank = cwi_vtkhdf_row_rank(a);
    cw_status st = CW_OK;
    while (rows && st == CW_OK) {
        hsize_t start[CWI_VTKHDF_RANK] = {0}, count[CWI_VTKHDF_RANK];
        uint64_t left = first, inner = 1, taken;
        uint32_t at = rank - 1;
        for (uint32_t n = rank; n-- > 0; left /= a->dim[n])
            start[n] = left % a->dim[n];
        while (at > 0 && start[at] == 0 && rows >= inner * a->dim[at])
            inner *= a->dim[at--];
        for (uint32_t n = 0; n < a->rank; n++)
            count[n] = n < at ? 1 : a->dim[n];
        taken = a->dim[at] - start[at];
        taken = taken < rows / inner ? taken : rows / inner;
        count[at] = taken;
        st = read_block(f, a, start, count, to, err);
        first += taken * inner;
        rows -= taken * inner;
        to += taken * inner * row_bytes;
    }
    return st;
}

static cw_status copy_rows(cwi_hdf5_file *f, const cwi_plane_request *q, void *shared,
                           cw_error *err)
{
    const cwi_vtkhdf_array *a = &f->facts.arrays[q->plane];
    if (q->plane >= f->facts.array_count || *a->refusal || a->rank == 0)
        return cwi_fail(err, CW_ERR_FORMAT, "there is no array %u", q->plane);
    const uint32_t rank = cwi_vtkhdf_row_rank(a);
    uint64_t rows = 1, bytes = cwi_vtkhdf_number_bytes(a->number);
    bool fits = true;
    for (uint32_t n = 0; n < a->rank; n++)
        fits = fits && !__builtin_mul_overflow(n < rank ? rows : bytes, a->dim[n],
                                               n < rank ? &rows : &bytes);
    if (!fits || q->first_row > rows || q->row_count > rows - q->first_row || bytes == 0 ||
        q->row_count > CWI_PLANES_SHARED / bytes)
        return cwi_fail(err, CW_ERR_FORMAT, "'%s' has no rows %u to %u", a->name, q->first_row,
                        q->first_row + q->row_count);
    cw_status st = cwi_hdf5_open_array(f, q->plane, err);
    return st == CW_OK ? read_rows(f, a, q->first_row, q->row_count, bytes, shared, err) : st;
}

/* --- the file ----------------------------------------------------------------------------- */

static void close_file(cwi_hdf5_file *f)
{
    cwi_hdf5_close_array(f);
    if (f->group >= 0)
        H5Oclose(f->group);
    if (f->file >= 0)
        H5Fclose(f->file);
    if (f->bytes.fd >= 0)
        close(f->bytes.fd);
    f->bytes.fd = -1;
    f->file = f->group = -1;
}

static cw_status open_file(cwi_hdf5_file *f, int fd, uint64_t bytes, cw_error *err)
{
    close_file(f);
    memset(&f->facts, 0, sizeof f->facts);
    f->bytes = (cwi_hdf5_bytes){.fd = fd, .end = bytes};
    f->file = cwi_hdf5_open(&f->bytes);
    return f->file >= 0 ? cwi_hdf5_list(f, err)
                        : cwi_hdf5_fail("the head of the HDF5 file", err);
}

static cw_status answer(cwi_hdf5_file *f, int fd, const cwi_plane_request *q, void *shared,
                        cw_error *err)
{
    if (q->op == CWI_PLANE_PIXELS)
        return copy_rows(f, q, shared, err);
    cw_status st = open_file(f, fd, q->file_bytes, err);
    memcpy(shared, &f->facts, sizeof f->facts);
    return st;
}

/* Some builds of the library are not for several threads. */
static pthread_mutex_t turn = PTHREAD_MUTEX_INITIALIZER;

/* Works while the library neither prints nor loads filters; both are as before afterwards. */
static cw_status work_on_request(void *state, int fd, const void *request, void *shared,
                                 cw_error *err)
{
    cwi_plane_request q;
    H5E_auto2_t print = NULL;
    void *print_to = NULL;
    unsigned plugins = 0;
    memcpy(&q, request, sizeof q);
    pthread_mutex_lock(&turn);
    H5Eget_auto2(H5E_DEFAULT, &print, &print_to);
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    H5PLget_loading_state(&plugins);
    H5PLset_loading_state(0);
    cw_status st = answer(state, fd, &q, shared, err);
    H5PLset_loading_state(plugins);
    H5Eset_auto2(H5E_DEFAULT, print, print_to);
    pthread_mutex_unlock(&turn);
    return st;
}

static void *state_new(void)
{
    cwi_hdf5_file *f = cwi_alloc_zeroed(1, sizeof *f);
    if (f) {
        f->bytes.fd = -1;
        f->file = f->group = f->dataset = -1;
    }
    return f;
}

static void state_free(void *state)
{
    pthread_mutex_lock(&turn);
    close_file(state);
    pthread_mutex_unlock(&turn);
    cwi_free(state);
}

static cw_status start_library(cw_error *err)
{
    return H5open() >= 0 ? CW_OK : cwi_fail(err, CW_ERR_BACKEND, "HDF5 does not start");
}

const cwi_plane_functions cwi_module_hdf5 = {state_new, state_free, start_library,
                                             work_on_request};
