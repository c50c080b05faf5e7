/* Reads volumes from a file, a folder or a series: finds the reader by name, content or
 * extension. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/volume/volume.h"
#include "formats/bytes/file_pattern.h"
#include "formats/format_lookup.h"
#include "formats/label_numbers.h"
#include "formats/mesh/mesh_reader.h"
#include "formats/raw/raw_format.h"
#include "formats/volume/frame_claim.h"
#include "formats/volume/named_arrays.h"
#include "formats/volume/no_data.h"
#include "formats/volume/slice_visit.h"
#include "formats/volume/volume_reader.h"
#include "formats/vtk/pvd.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

typedef cwi_format_driver driver;

/* --- files of a path -------------------------------------------------------------------- */

/* The files of a path: one file, or all those of a folder or a pattern. */
typedef struct opened {
    cwi_input in;
    cwi_names names;
    size_t links; /* number of links that were left out */
    bool many;
    const driver *reader; /* NULL: raw */
} opened;

static void close_path(opened *o)
{
    cwi_names_free(&o->names);
    cwi_input_close(&o->in);
}

static cw_status open_names(opened *o, const char *path, const cw_read_desc *desc,
                            cw_error *err)
{
    cw_status st = cwi_files_find(&o->in, path, !desc->raw, &o->names, &o->links, err);
    if (st == CW_OK && o->names.count == 0 && o->links)
        return cwi_fail(
            err, CW_ERR_IO,
            "the folder holds no file, only %zu links; desc->allow_external follows them",
            o->links);
    if (st == CW_OK && o->names.count == 0)
        return cwi_fail(err, CW_ERR_IO, "the folder holds no file");
    if (st == CW_OK)
        cwi_note_links(desc, o->links);
    return st;
}

/* Returns true if a file of the folder has a format. A file that cannot be read has none. */
static bool is_of(const cwi_input *in, const char *name, const driver *r)
{
    unsigned char head[CWI_SNIFF_BYTES];
    uint64_t file_size;
    size_t size;
    int fd;
    if (cwi_input_open_side(in, name, &fd, &file_size, NULL) != CW_OK)
        return false;
    const bool read = cwi_input_read_at(fd, 0, head, sizeof head, &size, NULL) == CW_OK;
    close(fd);
    return read && r->volume.sniff && r->volume.sniff(head, size);
}

/* Reports a folder without slices: says if it holds volumes, or links. */
static cw_status fail_no_slice(const opened *o, cw_error *err)
{
    char links[96] = "", all[320] = "";
    if (o->links)
        snprintf(links, sizeof links,
                 "; %zu links were left out, desc->allow_external follows them", o->links);
    for (size_t r = 0; cwi_format_at(r); r++) {
        size_t count = 0;
        const char *last = NULL;
        for (size_t i = 0; i < o->names.count; i++)
            if (is_of(&o->in, o->names.items[i], cwi_format_at(r))) {
                last = o->names.items[i];
                count++;
            }
        const size_t length = strlen(o->in.path);
        if (count > 1 && !cwi_files_is_pattern(o->in.path) && strrchr(last, '.'))
            snprintf(all, sizeof all,
                     ", or the steps of a series by a pattern in quotes, '%.200s%s*%.16s'",
                     o->in.path, o->in.path[length - 1] == '/' ? "" : "/", strrchr(last, '.'));
        if (count > 0)
            return cwi_fail(
                err, CW_ERR_FORMAT,
                "none of its %zu files is a slice; volumes by themselves: %zu (%s), "
                "name one of them%s%s",
                o->names.count, count, cwi_format_at(r)->name, all, links);
    }
    return cwi_fail(
        err, CW_ERR_FORMAT,
        "none of its %zu files is a slice in a format that is read (DICOM, TIFF, PNG, BMP)%s; "
        "headerless slices need their layout stated (desc->raw)",
        o->names.count, links);
}

static cw_status find_by_files(opened *o, cw_error *err)
{
    for (size_t r = 0; cwi_format_at(r); r++)
        for (size_t i = 0; cwi_format_at(r)->volume.read_slices && i < o->names.count; i++)
            if (is_of(&o->in, o->names.items[i], cwi_format_at(r))) {
                o->reader = cwi_format_at(r);
                return CW_OK;
            }
    return fail_no_slice(o, err);
}

/* Finds the format of files whose points are in another file. */
static const driver *find_with_points(void)
{
    size_t n = 0;
    while (!cwi_format_at(n)->volume.needs_points)
        n++;
    return cwi_format_at(n);
}

static cw_status find_reader(opened *o, const cw_read_desc *desc, cw_error *err)
{
    const char *name = desc->reader || !desc->points ? desc->reader : find_with_points()->name;
    cw_status st = name      ? cwi_volume_reader_by_name(name, &o->reader, err)
                   : o->many ? find_by_files(o, err)
                             : cwi_volume_reader_of(&o->in, &o->reader, err);
    if (st == CW_OK && o->many && !o->reader->volume.read_slices)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "the reader '%s' reads one file, and these are %zu", o->reader->name,
                        o->names.count);
    return st;
}

/* Finds the format of a folder that is one volume, or returns NULL. */
static const driver *find_store(const char *path, const cw_read_desc *desc)
{
    const driver *found = NULL;
    cwi_input folder;
    if (desc->raw || !cwi_is_folder(path) ||
        cwi_input_open_folder(&folder, path, NULL) != CW_OK)
        return NULL;
    folder.allow_external = desc->allow_external;
    for (size_t n = 0; cwi_format_at(n) && !found; n++) {
        const driver *f = cwi_format_at(n);
        const bool is_named = desc->reader && strcmp(desc->reader, f->name) == 0;
        if (f->volume.is_store && (is_named || (!desc->reader && f->volume.is_store(&folder))))
            found = f;
    }
    cwi_input_close(&folder);
    return found;
}

/* Refuses one of the many files of a store, such as Zarr's. */
static cw_status refuse_store(const driver *r, cw_error *err)
{
    return r && r->volume.is_store
               ? cwi_fail(err, CW_ERR_UNSUPPORTED,
                          "this is one of the many files of a folder (%s): the others are "
                          "missing, and data without a path have no files beside them",
                          r->name)
               : CW_OK;
}

/* Opens a file that has no path. */
static cw_status open_stored(opened *o, const cw_read_desc *desc, cw_error *err)
{
    cw_status st = cwi_input_open_stored(&o->in, desc->stored, err);
    o->in.array = desc->array;
    if (st == CW_OK && !desc->raw)
        st = find_reader(o, desc, err);
    return st == CW_OK ? refuse_store(o->reader, err) : st;
}

static cw_status open_path(opened *o, const char *path, const cw_read_desc *desc, cw_error *err)
{
    *o = (opened){.in = {.allow_external = desc->allow_external}};
    if (desc->stored)
        return open_stored(o, desc, err);
    o->reader = find_store(path, desc);
    if (o->reader) {
        cw_status st = cwi_input_open_folder(&o->in, path, err);
        o->in.allow_external = desc->allow_external;
        o->in.array = desc->array;
        return st;
    }
    o->many = cwi_files_is_pattern(path) || cwi_is_folder(path);
    cw_status st = o->many ? open_names(o, path, desc, err) : cwi_input_open(&o->in, path, err);
    o->in.allow_external |= desc->allow_external;
    o->in.array = desc->array;
    return st == CW_OK && !desc->raw ? find_reader(o, desc, err) : st;
}

/* --- reading ------------------------------------------------------------------------------ */

/* Checks that files in a row hold whole slices, the same number each. */
static cw_status check_part_bytes(const cw_volume *v, size_t files, cw_error *err)
{
    const size_t slices = v->dim[2] * v->steps;
    return slices % files == 0
               ? CW_OK
               : cwi_fail(err, CW_ERR_FORMAT, "'dims' asks for %zu slices; there are %zu files",
                          slices, files);
}

static cw_status refuse_array(const char *array, cw_error *err)
{
    return cwi_fail(err, CW_ERR_ARGUMENT,
                    "'%s' was asked for; files of this format have no arrays with names",
                    array);
}

/* Reads headers that become a source, and layouts. */
static cw_status read_source(opened *o, const cw_read_desc *desc, cw_volume *volume,
                             cw_error *err)
{
    cwi_source src = {0};
    cw_status st = desc->raw ? cwi_raw_describe(desc->raw, &src, err)
                             : o->reader->volume.parse(&o->in, &src, err);
    if (st == CW_OK && desc->array && !src.has_arrays)
        st = refuse_array(desc->array, err);
    if (st == CW_OK && *src.note)
        cwi_note(desc, "%s", src.note);
    if (st == CW_OK && o->many)
        st = check_part_bytes(&src.shape, o->names.count, err);
    if (st == CW_OK && desc->ids)
        st = cwi_source_keep_wide(&src, err);
    src.may_widen = true;
    if (o->many) {
        src.files = o->names;
        o->names = (cwi_names){0};
    }
    if (st == CW_OK)
        st = cwi_check_frame(&src.shape, src.frame_field, err);
    if (st == CW_OK)
        cwi_set_spacing(&src.shape, desc);
    if (st == CW_OK)
        st = o->in.visit ? cwi_source_visit(&src, &o->in, desc, err)
                         : cwi_source_load(&src, &o->in, desc, volume, err);
    cwi_source_free(&src);
    return st;
}

/* Reads the volume of one file by itself. */
static cw_status read_one(opened *o, const cw_read_desc *desc, cw_volume *volume, cw_error *err)
{
    bool is_grid = false;
    cw_status st = CW_OK;
    if (o->reader && o->reader->volume.read_grid)
        st = o->reader->volume.read_grid(&o->in, desc, &is_grid, volume, err);
    return st == CW_OK && !is_grid ? read_source(o, desc, volume, err) : st;
}

static cw_status check_spacing(const cw_read_desc *desc, cw_error *err)
{
    const double *s = desc->spacing_mm;
    if (s[0] == 0 && s[1] == 0 && s[2] == 0)
        return CW_OK;
    for (int a = 0; a < 3; a++)
        if (!(s[a] > 0) || !isfinite(s[a]))
            return cwi_fail(err, CW_ERR_ARGUMENT, "a spacing of %g mm; it must be above 0",
                            s[a]);
    return desc->claim.has_unit
               ? cwi_fail(err, CW_ERR_ARGUMENT,
                          "its spacing in mm and its unit are both said (desc->spacing_mm, "
                          "desc->claim.unit): one was expected")
               : CW_OK;
}

/* Refuses a preview of a grid with cells or leaves, which are always read whole. */
static cw_status expect_thin(const cw_read_desc *desc, cw_volume *v, cw_error *err)
{
    cw_status st = CW_OK;
    if ((desc->every[0] > 1 || desc->every[1] > 1 || desc->every[2] > 1) &&
        (v->cells || v->sparse))
        st = cwi_volume_expect_even(v, "a preview", err);
    if (st != CW_OK)
        cw_volume_free(v);
    return st;
}

/* Notes the choice among several arrays. For grids of OpenVDB their reader does it. */
static void tell_arrays(const opened *o, const cw_read_desc *desc, const cwi_array_list *arrays)
{
    char text[240];
    const bool has_grids = o->reader && o->reader->volume.tells_arrays;
    if (!has_grids && cwi_array_list_tell(arrays, text, sizeof text))
        cwi_note(desc, "%s", text);
}

static cw_status read_opened(opened *o, const cw_read_desc *desc, cw_volume *volume,
                             cw_error *err)
{
    const cwi_volume_reading none = {0}, *r = o->reader ? &o->reader->volume : &none;
    if (desc->level > 0 && !r->list_levels)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "level %zu was asked for; files of this format have no levels",
                        desc->level);
    if (r->read_slices && desc->array && (o->many || !r->holds_pages))
        return refuse_array(desc->array, err);
    if (r->read_slices)
        return r->read_slices(&o->in, o->many ? &o->names : NULL, desc, volume, err);
    return r->read_file ? r->read_file(&o->in, desc, volume, err)
                        : read_one(o, desc, volume, err);
}

cw_status cw_volume_read(const char *path, const cw_read_desc *desc, cw_volume *volume,
                         const char **format, cw_error *err)
{
    path = cwi_input_name(path, desc ? desc->stored : NULL);
    CWI_REQUIRE(err, path, volume);
    CWI_REQUIRE_VERSION(err, desc, 0);
    const cw_read_desc d = desc ? *desc : (cw_read_desc){0};
    cwi_array_list arrays = {0};
    opened o = {0};
    memset(volume, 0, sizeof *volume);
    if (d.labels)
        cw_label_table_free(d.labels);
    if (d.ids)
        cw_label_ids_free(d.ids);
    cw_status st = check_spacing(&d, err);
    if (st == CW_OK)
        st = open_path(&o, path, &d, err);
    o.in.arrays = d.note && !d.array ? &arrays : NULL;
    o.in.labels = d.labels;
    if (st == CW_OK)
        st = read_opened(&o, &d, volume, err);
    if (st == CW_OK && ((st = cwi_claim_volume(&d.claim, volume, err)) != CW_OK ||
                        (st = cwi_set_nodata(&d, volume, err)) != CW_OK))
        cw_volume_free(volume);
    if (st == CW_OK)
        st = expect_thin(&d, volume, err);
    if (st == CW_OK && d.ids)
        st = cwi_renumber_volume(&d, volume, err);
    if (st == CW_OK)
        tell_arrays(&o, &d, &arrays);
    else if (d.labels)
        cw_label_table_free(d.labels);
    if (format)
        *format = o.reader ? o.reader->name : d.raw ? "raw" : NULL;
    close_path(&o);
    cwi_array_list_free(&arrays);
    return st == CW_OK ? CW_OK : cwi_fail_in(err, st, path);
}

/* A visit whose slices have the axes and the no-data value that the caller claims. */
typedef struct claimed_visit {
    const char *path;
    const cw_read_desc *desc;
    const cw_slice_visitor *visitor;
    const cw_slice_source *source; /* of the reader */
    bool is_stored;                /* voxels are given as they are in the file */
} claimed_visit;

static cw_status read_named(void *user, size_t first, size_t count, void *to, cw_error *err)
{
    const claimed_visit *c = user;
    cw_status st = c->source->read(c->source->user, first, count, to, err);
    return st == CW_OK ? CW_OK : cwi_fail_in(err, st, c->path);
}

static cw_status visit_claimed(void *user, const cw_slice_source *source, cw_error *err)
{
    claimed_visit *c = user;
    cw_slice_source claimed = {.shape = source->shape, .read = read_named, .user = c};
    c->source = source;
    cw_status st = cwi_claim_volume(&c->desc->claim, &claimed.shape, err);
    if (st == CW_OK)
        st = cwi_set_nodata(c->desc, &claimed.shape, err);
    if (st == CW_OK && c->desc->ids && !c->is_stored)
        return cwi_visit_renumbered(c->desc, &claimed, c->visitor, err);
    return st == CW_OK ? c->visitor->visit(c->visitor->user, &claimed, err) : st;
}

static cw_status visit_path(claimed_visit *claimed, size_t component, size_t step,
                            const char **format, cw_error *err)
{
    const char *path = claimed->path;
    const cw_read_desc d = *claimed->desc;
    cwi_slice_visit visit = {
        .component = component, .step = step, .visit = visit_claimed, .user = claimed};
    opened o = {0};
    cw_volume none = {0};
    cw_status st = check_spacing(&d, err);
    if (st == CW_OK)
        st = open_path(&o, path, &d, err);
    o.in.visit = &visit;
    if (st == CW_OK)
        st = read_opened(&o, &d, &none, err);
    if (st == CW_OK && !visit.called)
        st = cwi_fail(err, CW_ERR_UNSUPPORTED, "%s is not read slice by slice",
                      cwi_volume_kind(&none) ? cwi_volume_kind(&none) : "this format");
    cw_volume_free(&none);
    if (format)
        *format = o.reader ? o.reader->name : d.raw ? "raw" : NULL;
    close_path(&o);
    return st == CW_OK || visit.called ? st : cwi_fail_in(err, st, path);
}

cw_status cw_volume_visit(const char *path, const cw_read_desc *desc, size_t component,
                          size_t step, const cw_slice_visitor *visitor, const char **format,
                          cw_error *err)
{
    path = cwi_input_name(path, desc ? desc->stored : NULL);
    CWI_REQUIRE(err, path, visitor);
    CWI_REQUIRE_VERSION(err, desc, 0);
    const cw_read_desc d = desc ? *desc : (cw_read_desc){0};
    claimed_visit claimed = {.path = path, .desc = &d, .visitor = visitor};
    return visit_path(&claimed, component, step, format, err);
}

cw_status cwi_visit_stored(const char *path, const cw_read_desc *desc, size_t component,
                           size_t step, const cw_slice_visitor *visitor, cw_error *err)
{
    claimed_visit claimed = {.path = path, .desc = desc, .visitor = visitor, .is_stored = true};
    return visit_path(&claimed, component, step, NULL, err);
}

/* Returns true for files of which none has images to choose from. */
static bool is_of_slices(const opened *o)
{
    const cwi_volume_reading *r = &o->reader->volume;
    return r->read_slices && (o->many || !r->holds_pages);
}

/* Lists the arrays of a file. Slices have no named arrays, and are many files, so their headers
 * are not read. */
cw_status cw_arrays_list(const char *path, const cw_read_desc *desc, cw_array **arrays,
                         size_t *count, cw_error *err)
{
    path = cwi_input_name(path, desc ? desc->stored : NULL);
    CWI_REQUIRE(err, path, arrays, count);
    CWI_REQUIRE_VERSION(err, desc, 0);
    cw_read_desc d = desc ? *desc : (cw_read_desc){0};
    cwi_array_list list = {0};
    opened o = {0};
    cw_volume shape = {0};
    d.header_only = true;
    d.array = NULL;
    d.region = NULL;
    d.labels = NULL;
    d.note = NULL;
    d.max_bytes = 0; /* no voxel is read */
    d.max_voxels = UINT64_MAX;
    cw_status st = open_path(&o, path, &d, err);
    o.in.arrays = &list;
    if (st == CW_OK && !(o.reader && is_of_slices(&o)))
        st = read_opened(&o, &d, &shape, err);
    if (st == CW_OK && list.starved)
        st = cwi_fail_memory(err);
    cw_volume_free(&shape);
    close_path(&o);
    if (st != CW_OK)
        cwi_array_list_free(&list);
    *arrays = list.items;
    *count = list.count;
    return st == CW_OK ? CW_OK : cwi_fail_in(err, st, path);
}

void cw_arrays_free(cw_array *arrays)
{
    cwi_free(arrays);
}

cw_status cw_levels_list(const char *path, const cw_read_desc *desc, cw_level **levels,
                         size_t *count, cw_error *err)
{
    path = cwi_input_name(path, desc ? desc->stored : NULL);
    CWI_REQUIRE(err, path, levels, count);
    CWI_REQUIRE_VERSION(err, desc, 0);
    const cw_read_desc d = desc ? *desc : (cw_read_desc){0};
    opened o = {0};
    *levels = NULL;
    *count = 0;
    cw_status st = open_path(&o, path, &d, err);
    if (st == CW_OK && o.reader && o.reader->volume.list_levels)
        st = o.reader->volume.list_levels(&o.in, &d, levels, count, err);
    close_path(&o);
    return st == CW_OK ? CW_OK : cwi_fail_in(err, st, path);
}

void cw_levels_free(cw_level *levels)
{
    cwi_free(levels);
}

cw_status cw_series_list(const char *path, const cw_read_desc *desc, cw_series **series,
                         size_t *count, cw_error *err)
{
    path = cwi_input_name(path, desc ? desc->stored : NULL);
    CWI_REQUIRE(err, path, series, count);
    CWI_REQUIRE_VERSION(err, desc, 0);
    const cw_read_desc defaults = {0};
    opened o = {0};
    *series = NULL;
    *count = 0;
    if (!desc)
        desc = &defaults;
    cw_status st = open_path(&o, path, desc, err);
    if (st == CW_OK && o.reader && o.reader->volume.list_series)
        st = o.reader->volume.list_series(&o.in, o.many ? &o.names : NULL, desc, series, count,
                                          err);
    close_path(&o);
    return st == CW_OK ? CW_OK : cwi_fail_in(err, st, path);
}

/* --- time series -------------------------------------------------------------------------- */

typedef enum kind { UNKNOWN, SLICE, VOLUME } kind;

/* Classifies a file. A DICOM image is a slice of its series; a TIFF file is one when it has a
 * single page. */
static kind kind_of(const char *path, const cw_read_desc *desc)
{
    cw_read_desc d = *desc;
    opened o;
    cw_volume shape;
    if (cwi_is_folder(path))
        return VOLUME;
    const bool known = open_path(&o, path, desc, NULL) == CW_OK;
    const bool slices = known && o.reader->volume.read_slices;
    const bool pages = slices && o.reader->volume.holds_pages;
    close_path(&o);
    d.header_only = true;
    d.labels = NULL;
    d.note = NULL;
    if (!pages)
        return slices ? SLICE : known ? VOLUME : UNKNOWN;
    const cw_status st = cw_volume_read(path, &d, &shape, NULL, NULL);
    return st == CW_OK && shape.dim[2] * shape.steps > 1 ? VOLUME : SLICE;
}

static cw_status add_path(const char *path, cwi_names *names, cw_error *err)
{
    cwi_input in = {0};
    cwi_names found = {0};
    size_t links;
    if (!cwi_files_is_pattern(path))
        return cwi_names_add(names, path, err);
    cw_status st = cwi_files_find(&in, path, false, &found, &links, err);
    cwi_input_close(&in);
    if (st != CW_OK)
        st = cwi_fail_in(err, st, path);
    for (size_t i = 0; i < found.count && st == CW_OK; i++)
        st = cwi_names_add(names, found.items[i], err);
    cwi_names_free(&found);
    return st;
}

/* Returns true if the files of a pattern are a series: none of them is a slice, and the first
 * file is a volume. Other files are refused later, by cw_volume_read(). */
static bool is_series(const cwi_names *names, const cw_read_desc *desc)
{
    for (size_t i = 0; i < names->count; i++)
        if (kind_of(names->items[i], desc) == SLICE)
            return false;
    return names->count > 0 && kind_of(names->items[0], desc) == VOLUME;
}

static cw_status refuse_slices(const cwi_names *names, const cw_read_desc *desc, cw_error *err)
{
    static const char hint[] = "slices in files of their own are one argument: name their "
                               "folder, or put quotes around a pattern";
    if (desc->raw)
        return cwi_fail(err, CW_ERR_ARGUMENT, "%zu files with one layout: %s", names->count,
                        hint);
    for (size_t i = 0; i < names->count; i++)
        if (kind_of(names->items[i], desc) == SLICE)
            return cwi_fail(err, CW_ERR_ARGUMENT,
                            "%s: is a slice, and of several files each must be a volume; %s",
                            names->items[i], hint);
    return CW_OK;
}

/* Finds the one reader of all files in a folder that have a format. Returns NULL if they have
 * several formats, or a slice is among them. Files without a format are removed from the
 * list. */
static const driver *find_common(const cwi_input *in, cwi_names *names)
{
    const driver *common = NULL;
    size_t kept = 0;
    bool mixed = false;
    for (size_t i = 0; i < names->count; i++) {
        size_t n = 0;
        while (cwi_format_at(n) && !is_of(in, names->items[i], cwi_format_at(n)))
            n++;
        const driver *r = cwi_format_at(n);
        if (r) {
            mixed = mixed || r->volume.read_slices || (common && common != r);
            common = r;
            names->items[kept++] = names->items[i];
        } else {
            cwi_free(names->items[i]);
        }
    }
    names->count = kept;
    return mixed ? NULL : common;
}

static bool have_numbers(const cwi_names *names)
{
    double *numbers = cwi_alloc_array(names->count, sizeof *numbers);
    const bool have = numbers && cwi_files_numbers(names, numbers);
    cwi_free(numbers);
    return have;
}

static cw_status add_below(const char *folder, const cwi_names *found, cwi_names *names,
                           cw_error *err)
{
    cw_status st = CW_OK;
    for (size_t i = 0; i < found->count && st == CW_OK; i++) {
        const size_t capacity = strlen(folder) + strlen(found->items[i]) + 2;
        char *path = cwi_alloc_array(capacity, 1);
        if (!path)
            return cwi_fail_memory(err);
        const bool slash = folder[strlen(folder) - 1] == '/';
        snprintf(path, capacity, "%s%s%s", folder, slash ? "" : "/", found->items[i]);
        st = cwi_names_add(names, path, err);
        cwi_free(path);
    }
    return st;
}

/* Lists the volumes of a folder, if they are a series: of one format, with names alike except
 * for a number. */
static cw_status list_folder(const char *folder, const cw_read_desc *desc, cwi_names *names,
                             cw_error *err)
{
    cwi_input in = {.allow_external = desc->allow_external};
    cwi_names found = {0};
    size_t links = 0;
    cw_status st = cwi_files_find(&in, folder, false, &found, &links, NULL);
    in.allow_external = in.allow_external || desc->allow_external;
    const bool is_series =
        st == CW_OK && found.count && find_common(&in, &found) && have_numbers(&found);
    cwi_input_close(&in);
    st = is_series ? add_below(folder, &found, names, err) : CW_OK;
    cwi_names_free(&found);
    return st;
}

static cw_status list_pvd(const char *path, const cw_read_desc *desc, cwi_names *names,
                          cw_error *err)
{
    cw_pvd_entry *entries;
    size_t count;
    cw_status st = cw_pvd_read(path, desc, &entries, &count, err);
    for (size_t n = 0; n < count && st == CW_OK; n++) {
        const char *mesh = cwi_mesh_format_of(entries[n].path);
        st = mesh ? cwi_fail(err, CW_ERR_FORMAT,
                             "%s: lists meshes, such as '%s' (%s), and not volumes: check, "
                             "convert and simplify take them, one at a time",
                             path, entries[n].path, mesh)
                  : cwi_names_add(names, entries[n].path, err);
    }
    cw_pvd_free(entries, count);
    return st;
}

/* Lists the files of several paths, or of a pattern. */
static cw_status list_paths(const char *const *paths, size_t path_count,
                            const cw_read_desc *desc, cwi_names *names, cw_error *err)
{
    const bool several = path_count > 1;
    cw_status st = CW_OK;
    for (size_t i = 0; i < path_count && st == CW_OK; i++)
        st =
            cw_pvd_is(paths[i])
                ? cwi_fail(err, CW_ERR_ARGUMENT,
                           "%s: a list of files (pvd) is a series by itself, and these are %zu "
                           "arguments",
                           paths[i], path_count)
                : add_path(paths[i], names, err);
    if (!several && (st != CW_OK || !is_series(names, desc))) {
        cwi_names_free(names);
        return CW_OK;
    }
    if (st == CW_OK)
        st = refuse_slices(names, desc, err);
    if (st == CW_OK)
        cwi_files_sort(names);
    return st;
}

cw_status cw_steps_list(const char *const *paths, size_t path_count, const cw_read_desc *desc,
                        char ***files, size_t *count, cw_error *err)
{
    CWI_REQUIRE(err, files, count, paths);
    CWI_REQUIRE_VERSION(err, desc, 0);
    if (path_count == 0)
        return cwi_fail(err, CW_ERR_ARGUMENT, "path_count is 0: at least one path is needed");
    const cw_read_desc d = desc ? *desc : (cw_read_desc){0};
    const bool several = path_count > 1, pattern = cwi_files_is_pattern(paths[0]);
    cwi_names names = {0};
    cw_status st = CW_OK;
    *files = NULL;
    *count = 0;
    if (d.stored)
        return CW_OK;
    if (several || (!d.raw && pattern))
        st = list_paths(paths, path_count, &d, &names, err);
    else if (!d.raw && !d.reader && cwi_is_folder(paths[0]) && !find_store(paths[0], &d))
        st = list_folder(paths[0], &d, &names, err);
    else if (!d.raw && cw_pvd_is(paths[0]))
        st = list_pvd(paths[0], &d, &names, err);
    if (st != CW_OK) {
        cwi_names_free(&names);
        return st;
    }
    *files = names.items;
    *count = names.count;
    return CW_OK;
}

void cw_steps_free(char **files, size_t count)
{
    cwi_names_free(&(cwi_names){files, count});
}
