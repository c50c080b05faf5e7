/* Lists the arrays of the group VTKHDF. Only hard links are followed, to groups of known names and to
 * datasets in them, so that neither circles nor other files are reached. */
#include "core/base/status.h"
#include "formats/vtkhdf/hdf5_attributes.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

enum { MAX_CHUNK_BYTES = 1 << 30 };

/* --- datasets ----------------------------------------------------------------------------- */

CW_PRINTF(2, 3) static void refuse(cwi_vtkhdf_array *a, const char *format, ...)
{
    va_list list;
    if (*a->refusal)
        return;
    va_start(list, format);
    vsnprintf(a->refusal, sizeof a->refusal, format, list);
    va_end(list);
}

static void take_shape(hid_t dataset, cwi_vtkhdf_array *a)
{
    const hid_t space = H5Dget_space(dataset);
    hsize_t dim[H5S_MAX_RANK];
    const int rank = H5Sget_simple_extent_type(space) == H5S_SIMPLE
                         ? H5Sget_simple_extent_dims(space, dim, NULL)
                         : 0;
    if (rank < 1 || rank > CWI_VTKHDF_RANK)
        refuse(a, "it has %d dimensions; 1 to %d are read", rank, CWI_VTKHDF_RANK);
    a->rank = rank < 1 ? 0 : rank > CWI_VTKHDF_RANK ? CWI_VTKHDF_RANK : (uint32_t)rank;
    for (uint32_t n = 0; n < a->rank; n++)
        a->dim[n] = dim[n];
    if (space >= 0)
        H5Sclose(space);
}

/* Sets the kind of numbers. Those that this project has no type for are converted by the library.
 * Returns true if they are in the file as they are returned, but for the order of bytes. */
static bool take_numbers(hid_t dataset, cwi_vtkhdf_array *a)
{
    const hid_t type = H5Dget_type(dataset);
    const H5T_class_t class = H5Tget_class(type);
    const size_t size = H5Tget_size(type);
    bool is_plain = false;
    if (class == H5T_INTEGER && (size == 1 || size == 2 || size == 4 || size == 8)) {
        const uint32_t log = size == 1 ? 0 : size == 2 ? 1 : size == 4 ? 2 : 3;
        a->number = CWI_VTKHDF_I8 + 2 * log + (H5Tget_sign(type) == H5T_SGN_NONE);
        is_plain = H5Tget_precision(type) == 8 * size;
    } else if (class == H5T_FLOAT && size <= 8) {
        a->number = size <= 4 ? CWI_VTKHDF_F32 : CWI_VTKHDF_F64;
        is_plain = H5Tequal(type, H5T_IEEE_F32LE) > 0 || H5Tequal(type, H5T_IEEE_F32BE) > 0 ||
                   H5Tequal(type, H5T_IEEE_F64LE) > 0 || H5Tequal(type, H5T_IEEE_F64BE) > 0;
    } else {
        refuse(a, "its values are no numbers of up to 64 bits");
    }
    a->big_endian = H5Tget_order(type) == H5T_ORDER_BE;
    H5Tclose(type);
    return is_plain;
}

static void check_filters(hid_t list, cwi_vtkhdf_array *a)
{
    const int count = H5Pget_nfilters(list);
    for (int n = 0; n < count; n++) {
        char name[40] = "";
        size_t values = 0;
        unsigned flags, config;
        const H5Z_filter_t filter = H5Pget_filter2(list, (unsigned)n, &flags, &values, NULL,
                                                   sizeof name, name, &config);
        name[sizeof name - 1] = '\0';
        const bool is_known = filter == H5Z_FILTER_DEFLATE || filter == H5Z_FILTER_SHUFFLE ||
                              filter == H5Z_FILTER_FLETCHER32 || filter == H5Z_FILTER_SZIP;
        if (!is_known || H5Zfilter_avail(filter) <= 0)
            refuse(a, "its filter %d%s%s is not read: 'h5repack -f NONE' takes it out",
                   (int)filter, *name ? ", " : "", name);
    }
}

static void check_chunks(hid_t list, cwi_vtkhdf_array *a)
{
    hsize_t dim[H5S_MAX_RANK];
    const int rank = H5Pget_chunk(list, H5S_MAX_RANK, dim);
    uint64_t bytes = cwi_vtkhdf_number_bytes(a->number);
    for (int n = 0; n < rank; n++)
        if (__builtin_mul_overflow(bytes, dim[n], &bytes))
            bytes = UINT64_MAX;
    if (rank < 1 || bytes > MAX_CHUNK_BYTES)
        refuse(a, "its chunks take %llu bytes; at most %d are read", (unsigned long long)bytes,
               MAX_CHUNK_BYTES);
}

static void take_layout(hid_t dataset, bool is_plain, cwi_vtkhdf_array *a)
{
    const hid_t list = H5Dget_create_plist(dataset);
    const H5D_layout_t layout = list >= 0 ? H5Pget_layout(list) : H5D_LAYOUT_ERROR;
    a->offset = UINT64_MAX;
    if (layout == H5D_CHUNKED)
        check_chunks(list, a);
    else if (layout == H5D_VIRTUAL || (layout == H5D_CONTIGUOUS && H5Pget_external_count(list)))
        refuse(a, "its values are in other files, which are not opened");
    else if (layout != H5D_CONTIGUOUS && layout != H5D_COMPACT)
        refuse(a, "its layout is not known");
    check_filters(list, a);
    if (!*a->refusal) {
        a->stored_bytes = H5Dget_storage_size(dataset);
        const haddr_t at =
            layout == H5D_CONTIGUOUS && is_plain ? H5Dget_offset(dataset) : HADDR_UNDEF;
        a->offset = at == HADDR_UNDEF ? UINT64_MAX : at;
    }
    if (list >= 0)
        H5Pclose(list);
}

static void describe(hid_t dataset, cwi_vtkhdf_array *a)
{
    take_shape(dataset, a);
    const bool is_plain = take_numbers(dataset, a);
    take_layout(dataset, is_plain, a);
}

/* --- groups ------------------------------------------------------------------------------- */

static const char *const groups[] = {"PointData",
                                     "CellData",
                                     "Vertices",
                                     "Lines",
                                     "Polygons",
                                     "Strips",
                                     "Steps",
                                     "Steps/PointDataOffsets",
                                     "Steps/CellDataOffsets"};

static bool is_known_group(const char *name)
{
    for (size_t n = 0; n < sizeof groups / sizeof *groups; n++)
        if (strcmp(groups[n], name) == 0)
            return true;
    return false;
}

typedef struct listing {
    cwi_vtkhdf_facts *facts;
    char path[CWI_VTKHDF_NAME]; /* of the group at hand, with a slash; "": VTKHDF itself */
    cw_error *err;
    cw_status status;
} listing;

static herr_t list_link(hid_t group, const char *name, const H5L_info_t *info, void *user);

static cw_status list_group(hid_t group, const char *path, listing *l)
{
    char before[CWI_VTKHDF_NAME];
    memcpy(before, l->path, sizeof before);
    snprintf(l->path, sizeof l->path, "%s%s", path, *path ? "/" : "");
    if (H5Literate(group, H5_INDEX_NAME, H5_ITER_INC, NULL, list_link, l) < 0 &&
        l->status == CW_OK)
        l->status = cwi_hdf5_fail(*path ? path : "the group VTKHDF", l->err);
    memcpy(l->path, before, sizeof before);
    return l->status;
}

static cwi_vtkhdf_array *add_array(listing *l, const char *path)
{
    cwi_vtkhdf_facts *f = l->facts;
    if (f->array_count == CWI_VTKHDF_ARRAYS) {
        l->status = cwi_fail(l->err, CW_ERR_LIMIT,
                             "the group VTKHDF has more than %d arrays, such as '%.100s'",
                             CWI_VTKHDF_ARRAYS, path);
        return NULL;
    }
    cwi_vtkhdf_array *a = &f->arrays[f->array_count++];
    *a = (cwi_vtkhdf_array){.offset = UINT64_MAX};
    snprintf(a->name, sizeof a->name, "%s", path);
    return a;
}

/* Lists what a hard link leads to: a dataset, or a group of a known name. */
static void list_object(listing *l, hid_t group, const char *name, const char *path)
{
    const hid_t object = H5Oopen(group, name, H5P_DEFAULT);
    const H5I_type_t kind = object >= 0 ? H5Iget_type(object) : H5I_BADID;
    if (object < 0) {
        cwi_vtkhdf_array *a = add_array(l, path);
        if (a)
            refuse(a, "its header is damaged");
        return;
    }
    if (kind == H5I_GROUP && is_known_group(path))
        list_group(object, path, l);
    else if (kind == H5I_DATASET) {
        cwi_vtkhdf_array *a = add_array(l, path);
        if (a)
            describe(object, a);
    }
    H5Oclose(object);
}

static herr_t list_link(hid_t group, const char *name, const H5L_info_t *info, void *user)
{
    listing *l = user;
    char path[CWI_VTKHDF_NAME];
    const int length = snprintf(path, sizeof path, "%s%s", l->path, name);
    if (length >= (int)sizeof path)
        return 0; /* no reader asks for such a long name */
    if (info->type == H5L_TYPE_HARD) {
        list_object(l, group, name, path);
    } else {
        cwi_vtkhdf_array *a = add_array(l, path);
        if (a)
            refuse(a, "it is a link%s, which is not followed",
                   info->type == H5L_TYPE_EXTERNAL ? " to another file" : "");
    }
    return l->status == CW_OK ? 0 : -1;
}

/* --- attributes --------------------------------------------------------------------------- */

static cw_status read_image(hid_t group, cwi_vtkhdf_facts *f, cw_error *err)
{
    bool has;
    for (int n = 0; n < 3; n++) {
        f->spacing[n] = 1;
        f->direction[4 * n] = 1;
    }
    cw_status st = cwi_hdf5_numbers(group, "WholeExtent", true, 6, f->extent, &has, err);
    f->has_extent = has;
    if (st == CW_OK)
        st = cwi_hdf5_numbers(group, "Origin", false, 3, f->origin, &has, err);
    if (st == CW_OK)
        st = cwi_hdf5_numbers(group, "Spacing", false, 3, f->spacing, &has, err);
    return st == CW_OK ? cwi_hdf5_numbers(group, "Direction", false, 9, f->direction, &has, err)
                       : st;
}

/* Opens a group behind a hard link; -1: there is none. */
static hid_t open_group(hid_t parent, const char *name)
{
    H5L_info_t info;
    if (H5Lexists(parent, name, H5P_DEFAULT) <= 0 ||
        H5Lget_info(parent, name, &info, H5P_DEFAULT) < 0 || info.type != H5L_TYPE_HARD)
        return -1;
    const hid_t object = H5Oopen(parent, name, H5P_DEFAULT);
    if (object >= 0 && H5Iget_type(object) != H5I_GROUP) {
        H5Oclose(object);
        return -1;
    }
    return object;
}

static cw_status read_names(hid_t group, cwi_vtkhdf_facts *f, cw_error *err)
{
    static const char *const data[2] = {"PointData", "CellData"};
    static const char *const names[CWI_VTKHDF_ATTRIBUTES] = {"Scalars", "Normals", "GlobalIds"};
    cw_status st = CW_OK;
    for (int n = 0; n < 2; n++) {
        const hid_t object = open_group(group, data[n]);
        for (int k = 0; k < CWI_VTKHDF_ATTRIBUTES && object >= 0 && st == CW_OK; k++)
            st = cwi_hdf5_text(object, names[k], f->names[n][k], CWI_VTKHDF_NAME, err);
        if (object >= 0)
            H5Oclose(object);
    }
    return st;
}

static cw_status read_steps(hid_t group, cwi_vtkhdf_facts *f, cw_error *err)
{
    bool has = false;
    const hid_t steps = open_group(group, "Steps");
    if (steps < 0)
        return CW_OK;
    f->has_steps = true;
    f->steps = 1;
    cw_status st = cwi_hdf5_numbers(steps, "NSteps", true, 1, &f->steps, &has, err);
    H5Oclose(steps);
    return st;
}

cw_status cwi_hdf5_list(cwi_hdf5_file *f, cw_error *err)
{
    cwi_vtkhdf_facts *facts = &f->facts;
    listing l = {.facts = facts, .err = err};
    bool has;
    f->group = open_group(f->file, "VTKHDF");
    if (f->group < 0)
        return cwi_fail(err, CW_ERR_FORMAT, "it has no group VTKHDF, or this is a link");
    cw_status st = cwi_hdf5_text(f->group, "Type", facts->type, sizeof facts->type, err);
    if (st == CW_OK)
        st = cwi_hdf5_numbers(f->group, "Version", true, 2, facts->version, &has, err);
    if (st == CW_OK)
        st = read_image(f->group, facts, err);
    if (st == CW_OK)
        st = read_names(f->group, facts, err);
    if (st == CW_OK)
        st = read_steps(f->group, facts, err);
    return st == CW_OK ? list_group(f->group, "", &l) : st;
}
