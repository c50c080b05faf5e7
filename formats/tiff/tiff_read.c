/* Reads TIFF stacks: the pages of one file, or slices in separate files. */
#include "formats/tiff/tiff.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "formats/tiff/tiff_format.h"
#include "formats/volume/named_arrays.h"
#include "formats/volume/slice_files.h"
#include "formats/volume/slice_stack.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_COMPRESSION = 65536, MAX_SAMPLES = 4, MAX_CHANNELS = 16 };

bool cwi_tiff_sniff(const unsigned char *head, size_t size)
{
    return size >= 4 && (memcmp(head, "II*\0", 4) == 0 || memcmp(head, "MM\0*", 4) == 0 ||
                         memcmp(head, "II+\0", 4) == 0 || memcmp(head, "MM\0+", 4) == 0);
}

/* --- the facts of one file ---------------------------------------------------------------- */

static uint64_t planes_of(const cwi_tiff_facts *f)
{
    return (uint64_t)f->slices * f->channels * f->steps; /* valid as each is below 2^17 */
}

/* Checks the claims of a file against its size, before anything is allocated for them. */
static cw_status check_claim(const cwi_tiff_facts *f, uint64_t file_bytes, cw_error *err)
{
    const uint64_t row = ((uint64_t)f->columns * f->samples * f->bits + 7) / 8; /* < 2^37 */
    const uint64_t ratio = f->compressed ? MAX_COMPRESSION : 1;
    uint64_t expected;
    if (!__builtin_mul_overflow(row * f->rows, planes_of(f), &expected) &&
        expected / ratio <= file_bytes)
        return CW_OK;
    return cwi_fail(err, CW_ERR_FORMAT,
                    "'ImageWidth' and 'ImageLength' ask for %llu pages of %u x %u pixels; the "
                    "file has %llu bytes%s",
                    (unsigned long long)planes_of(f), f->columns, f->rows,
                    (unsigned long long)file_bytes, f->compressed ? ", compressed" : "");
}

static bool is_said(double number)
{
    return isfinite(number) && number >= 0;
}

static cw_status check_numbers(const cwi_tiff_facts *f, cw_error *err)
{
    for (int a = 0; a < 3; a++)
        if (!is_said(f->spacing[a]) || !is_said(f->unit_mm[a]))
            return cwi_fail(err, CW_ERR_FORMAT,
                            "'ImageDescription' or 'XResolution' gives axis %d a spacing of %g",
                            a, f->spacing[a]);
    if (!is_said(f->pixel_mm[0]) || !is_said(f->pixel_mm[1]))
        return cwi_fail(err, CW_ERR_FORMAT, "'XResolution' gives pixels of %g mm",
                        f->pixel_mm[0]);
    if (!is_said(f->step_seconds) || !isfinite(f->slope) || !isfinite(f->intercept) ||
        f->slope == 0 || !isfinite(f->nodata))
        return cwi_fail(err, CW_ERR_FORMAT,
                        "'ImageDescription' has times or values that are not numbers");
    return CW_OK;
}

/* Checks the facts, which are untrusted: libtiff's process may have been taken over. */
static cw_status check_facts(const cwi_tiff_facts *f, uint64_t file_bytes, cw_error *err)
{
    const uint32_t max = CWI_TIFF_MAX_PAGES;
    if (f->columns < 1 || f->columns > INT32_MAX || f->rows < 1 || f->rows > INT32_MAX ||
        f->samples < 1 || f->samples > MAX_SAMPLES || f->bits < 1 || f->bits > 64 ||
        !cw_type_size(f->type) || f->page_count < 1 || f->page_count > max || f->slices < 1 ||
        f->slices > max || f->channels < 1 || f->channels > max || f->steps < 1 ||
        f->steps > max || planes_of(f) > f->page_count ||
        !memchr(f->note, '\0', sizeof f->note) || !memchr(f->names, '\0', sizeof f->names))
        return cwi_fail(err, CW_ERR_BACKEND, "libtiff's answer is not valid");
    if (f->channels > MAX_CHANNELS || (f->channels > 1 && f->samples > 1))
        return cwi_fail(
            err, CW_ERR_FORMAT,
            "%u channels of %u samples each; at most %d are read, and one of several",
            f->channels, f->samples, MAX_CHANNELS);
    if ((size_t)f->columns * f->samples * cw_type_size(f->type) > CWI_PLANES_SHARED)
        return cwi_fail(err, CW_ERR_LIMIT, "a row of %u pixels takes more than %d bytes",
                        f->columns, CWI_PLANES_SHARED);
    cw_status st = check_numbers(f, err);
    return st == CW_OK ? check_claim(f, file_bytes, err) : st;
}

/* Finds an image by its name, else by its number from 1 on. */
static cw_status find_image(const cwi_tiff_facts *f, const char *name, uint32_t *image,
                            cw_error *err)
{
    const size_t length = strlen(name);
    const char *line = f->names, *at = name;
    int64_t number;
    for (*image = 0; *line; line = cwi_tiff_next_line(line), ++*image)
        if (strncmp(line, name, length) == 0 && line[length] == '\n')
            return CW_OK;
    if (cwi_parse_int(&at, &number) && !*at && number >= 1 && number <= f->image_count) {
        *image = (uint32_t)number - 1;
        return CW_OK;
    }
    char names[240];
    size_t used = 0;
    for (line = f->names; *line && used + 4 < sizeof names; line = cwi_tiff_next_line(line))
        used += (size_t)snprintf(names + used, sizeof names - used, "%s'%.*s'",
                                 used ? ", " : "", (int)strcspn(line, "\n"), line);
    return cwi_fail(err, CW_ERR_ARGUMENT,
                    "there is no image '%.60s'; the file has %u: %s (desc->array)", name,
                    f->image_count, f->image_count ? names : "none has a name");
}

/* Lists the images for the caller, and marks the one that is read. */
static void list_images(const cwi_tiff_facts *f, uint32_t image, const cwi_input *in)
{
    uint32_t n = 0;
    for (const char *line = f->names; *line; line = cwi_tiff_next_line(line), n++) {
        char name[200];
        snprintf(name, sizeof name, "%.*s", (int)strcspn(line, "\n"), line);
        cwi_array_list_add(in->arrays, name, "image", 1, false, true);
        if (n == image)
            cwi_array_list_choose(in->arrays, name, false);
    }
}

/* Reads the facts. order may be NULL; else it is set to an array of the pages' numbers, to be
 * freed. */
static cw_status take_facts(cwi_planes *planes, int fd, uint64_t file_bytes, cwi_tiff_facts *f,
                            uint32_t **order, cw_error *err)
{
    const void *shared;
    cw_status st = cwi_planes_facts(planes, fd, file_bytes, &shared, err);
    if (st != CW_OK)
        return st;
    memcpy(f, shared, sizeof *f);
    st = check_facts(f, file_bytes, err);
    if (st != CW_OK || !order)
        return st;
    const size_t count = planes_of(f);
    *order = cwi_alloc_array(count, sizeof **order);
    if (!*order)
        return cwi_fail_memory(err);
    memcpy(*order, (const char *)shared + sizeof *f, count * sizeof **order);
    for (size_t i = 0; i < count; i++)
        if ((*order)[i] >= f->page_count)
            return cwi_fail(err, CW_ERR_BACKEND, "libtiff's answer is not valid");
    return CW_OK;
}

/* --- the stack ---------------------------------------------------------------------------- */

static void set_sizes(const cwi_tiff_facts *f, size_t slices, cwi_stack *stack)
{
    cw_volume *v = &stack->shape;
    const ptrdiff_t size = (ptrdiff_t)cw_type_size(f->type);
    stack->size_field = "ImageWidth, ImageLength";
    stack->type = v->type = f->type;
    stack->samples = f->samples;
    v->slope = f->slope;
    v->intercept = f->intercept;
    v->dim[0] = f->columns;
    v->dim[1] = f->rows;
    v->dim[2] = slices;
    v->steps = f->steps;
    v->step_seconds = f->step_seconds;
    v->has_nodata = stack->has_padding = f->has_nodata;
    v->nodata = stack->padding[0] = stack->padding[1] = f->nodata;
    v->stride[0] = size * (ptrdiff_t)f->samples;
    v->stride[1] = v->stride[0] * (ptrdiff_t)f->columns;
    v->stride[2] = v->stride[1] * (ptrdiff_t)f->rows;
    v->components = f->channels > 1 ? f->channels : f->samples;
    v->component_stride = f->channels > 1 ? v->stride[2] * (ptrdiff_t)slices : size;
    v->step_stride = v->stride[2] * (ptrdiff_t)slices * (ptrdiff_t)f->channels;
}

/* Sets the frame: millimetres where all axes have a distance between samples and a unit; else
 * the plain numbers. */
static void set_frame(const cwi_tiff_facts *f, const cw_read_desc *desc, cw_volume *v)
{
    bool known = true, some = false;
    for (int a = 0; a < 3; a++) {
        const bool is_stated = f->spacing[a] > 0 && f->unit_mm[a] > 0;
        known &= is_stated || (v->dim[a] == 1 && a == 2);
        some |= is_stated;
    }
    for (int a = 0; a < 3; a++) {
        const double unit = known ? f->unit_mm[a] : 1;
        v->affine[a][a] = f->spacing[a] > 0 && unit > 0 ? f->spacing[a] * unit
                          : known                       ? v->affine[0][0]
                                                        : 1;
    }
    v->known = known ? CW_KNOWN_UNIT : 0;
    v->said_unit_mm = known ? f->unit_mm[0] : 0;
    if (some && !known && !(desc->spacing_mm[0] > 0))
        cwi_note(desc,
                 "the file does not say all sizes of a voxel: what is missing is taken as "
                 "1, and no unit is known; desc->spacing_mm states them");
    if (!some && f->pixel_mm[0] > 0 && !(desc->spacing_mm[0] > 0))
        cwi_note(
            desc,
            "'XResolution' and 'YResolution' state pixels of %.6g x %.6g mm, which may be for "
            "print: they are not used; desc->spacing_mm states what is so",
            f->pixel_mm[0], f->pixel_mm[1]);
}

static int by_plane(const void *x, const void *y)
{
    const cwi_slot *a = x, *b = y;
    return (a->low > b->low) - (a->low < b->low);
}

/* Stacks the pages of one file, read from start to end. */
static cw_status stack_pages(const cwi_tiff_facts *f, const uint32_t *order, cwi_stack *stack,
                             cw_error *err)
{
    const size_t count = planes_of(f);
    cw_status st = cwi_stack_reserve(stack, f->page_count, count, err);
    if (st != CW_OK)
        return st;
    set_sizes(f, f->slices, stack);
    for (uint32_t p = 0; p < f->page_count; p++)
        stack->planes[p].number = p;
    for (size_t i = 0; i < count; i++)
        stack->slots[i] = (cwi_slot){.slice = i, .low = order[i], .high = order[i]};
    qsort(stack->slots, count, sizeof *stack->slots, by_plane);
    return CW_OK;
}

/* --- slices in files of their own --------------------------------------------------------- */

typedef struct slices {
    const cwi_input *in;
    cwi_planes *planes;
    const cw_read_desc *desc;
    cwi_names files;            /* the TIFF files */
    cwi_tiff_facts facts, last; /* of the first file, of the last one */
    uint32_t *order;
} slices;

static cw_status check_alike(const cwi_tiff_facts *a, const cwi_tiff_facts *b, cw_error *err)
{
    if (a->page_count > 1 || b->page_count > 1)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "it holds %u pages; slices in files of their own have one each",
                        a->page_count > 1 ? a->page_count : b->page_count);
    if (a->columns != b->columns || a->rows != b->rows || a->samples != b->samples ||
        a->type != b->type || a->bits != b->bits)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "it is %u x %u, %u x %u bits (%s); the first is %u x %u, %u x %u bits "
                        "(%s)",
                        b->columns, b->rows, b->samples, b->bits, cw_type_name(b->type),
                        a->columns, a->rows, a->samples, a->bits, cw_type_name(a->type));
    for (int i = 0; i < 2; i++)
        if (!(fabs(a->spacing[i] * a->unit_mm[i] - b->spacing[i] * b->unit_mm[i]) <=
              1e-4 * a->spacing[i] * a->unit_mm[i]))
            return cwi_fail(err, CW_ERR_FORMAT,
                            "its pixels are %.6g mm along axis %d; the first's are %.6g",
                            b->spacing[i] * b->unit_mm[i], i, a->spacing[i] * a->unit_mm[i]);
    return CW_OK;
}

/* Reads the facts of one of the files; those of the first one are kept. */
static cw_status look_into(void *user, int fd, uint64_t size, bool is_first, cw_error *err)
{
    slices *s = user;
    cwi_tiff_facts *f = &s->last;
    cwi_free(is_first ? s->order : NULL);
    s->order = is_first ? NULL : s->order;
    cw_status st = take_facts(s->planes, fd, size, f, is_first ? &s->order : NULL, err);
    if (st == CW_OK && s->desc->skip_damaged && f->compressed)
        st = cwi_planes_try(s->planes, f->page_count, f->rows,
                            (size_t)f->columns * f->samples * cw_type_size(f->type), err);
    if (st == CW_OK && is_first)
        s->facts = *f;
    return st;
}

static cw_status compare_last(void *user, cw_error *err)
{
    const slices *s = user;
    return check_alike(&s->facts, &s->last, err);
}

static cw_status stack_files(slices *s, cwi_stack *stack, cw_error *err)
{
    size_t count = 0;
    cw_status st = cwi_slice_files_stack(&s->files, s->desc, stack, &count, err);
    if (st == CW_OK)
        set_sizes(&s->facts, count, stack);
    return st;
}

/* --- reading ------------------------------------------------------------------------------ */

static void note_facts(const cw_read_desc *desc, cwi_tiff_facts *f)
{
    if (f->turned)
        cwi_note(desc, "'PhotometricInterpretation' is 0 (white is 0): values are inverted, so "
                       "that larger is brighter");
    for (char *c = f->note; *c; c++)
        if ((unsigned char)*c < ' ' || (unsigned char)*c > '~')
            *c = '?';
    if (f->note[0])
        cwi_note(desc, "%s", f->note);
}

/* Reads the facts of the file's image, or of the one that was asked for. */
static cw_status take_image(slices *s, cw_error *err)
{
    uint32_t image = 0;
    cw_status st = take_facts(s->planes, s->in->fd, s->in->size, &s->facts, &s->order, err);
    if (st == CW_OK && s->in->array)
        st = find_image(&s->facts, s->in->array, &image, err);
    if (st == CW_OK && image > 0) {
        s->planes->image = image;
        cwi_free(s->order);
        s->order = NULL;
        st = take_facts(s->planes, s->in->fd, s->in->size, &s->facts, &s->order, err);
    }
    if (st == CW_OK && s->facts.image_count > 1)
        list_images(&s->facts, image, s->in);
    return st;
}

static cw_status find_stack(slices *s, const cwi_names *names, cwi_stack *stack, cw_error *err)
{
    cw_status st = CW_OK;
    if (names) {
        const cwi_slice_kind kind = {.name = "TIFF",
                                     .extensions = ".tif .tiff",
                                     .sniff = cwi_tiff_sniff,
                                     .look = look_into,
                                     .compare = compare_last,
                                     .user = s};
        st = cwi_slice_files_find(&kind, s->in, names, s->desc, &s->files, err);
        if (st == CW_OK)
            st = cwi_slice_files_look(&kind, s->in, s->planes, s->desc, &s->files, err);
    } else {
        st = take_image(s, err);
    }
    if (st == CW_OK)
        st = s->files.count > 1 ? stack_files(s, stack, err)
                                : stack_pages(&s->facts, s->order, stack, err);
    return st;
}

cw_status cwi_tiff_read(const cwi_input *in, cwi_names *names, const cw_read_desc *desc,
                        cw_volume *volume, cw_error *err)
{
    cwi_planes planes = {0};
    cwi_stack stack = {0};
    slices s = {.in = in, .planes = &planes, .desc = desc};
    cw_status st = cwi_planes_open(&planes, "tiff", "libtiff", desc, err);
    if (st == CW_OK)
        st = find_stack(&s, names, &stack, err);
    if (st == CW_OK) {
        note_facts(desc, &s.facts);
        set_frame(&s.facts, desc, &stack.shape);
        st = cwi_check_frame(&stack.shape, "ImageDescription", err);
    }
    if (st == CW_OK) {
        cwi_set_spacing(&stack.shape, desc);
        stack.files = s.files;
        s.files = (cwi_names){0};
        st = cwi_stack_load(&stack, in, &planes, desc, volume, err);
    }
    cwi_names_free(&s.files);
    cwi_free(s.order);
    cwi_stack_free(&stack);
    cwi_planes_close(&planes);
    return st;
}
