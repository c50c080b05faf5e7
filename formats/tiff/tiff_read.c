/* Reads TIFF stacks: the pages of one file, or slices in separate files. */
#include "formats/tiff/tiff.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "formats/bytes/file_pattern.h"
#include "formats/tiff/tiff_format.h"
#include "formats/volume/damaged_files.h"
#include "formats/volume/named_arrays.h"
#include "formats/volume/slice_spacing.h"
#include "formats/volume/slice_stack.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

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

static cw_status ensure_capacity(cwi_stack *stack, size_t planes, size_t slots, cw_error *err)
{
    stack->planes = cwi_alloc_zeroed(planes, sizeof *stack->planes);
    stack->slots = cwi_alloc_zeroed(slots, sizeof *stack->slots);
    stack->plane_count = planes;
    stack->slot_count = slots;
    return stack->planes && stack->slots ? CW_OK : cwi_fail_memory(err);
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
    cw_status st = ensure_capacity(stack, f->page_count, count, err);
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
    cwi_names files; /* the TIFF files */
    cwi_tiff_facts facts;
    uint32_t *order;
} slices;

/* Returns true for a TIFF file, by name, else by content: a damaged slice counts, too. */
static bool is_tiff(const cwi_input *in, const char *name)
{
    unsigned char head[4];
    uint64_t size;
    size_t got = 0;
    int fd;
    if (cwi_has_extension(name, ".tif .tiff"))
        return true;
    if (cwi_input_open_side(in, name, &fd, &size, NULL) != CW_OK)
        return false;
    const bool read = cwi_input_read_at(fd, 0, head, sizeof head, &got, NULL) == CW_OK;
    close(fd);
    return read && cwi_tiff_sniff(head, got);
}

static cw_status find_files(slices *s, const cwi_names *names, cw_error *err)
{
    cw_status st = CW_OK;
    for (size_t i = 0; st == CW_OK && i < names->count; i++)
        if (is_tiff(s->in, names->items[i]))
            st = cwi_names_add(&s->files, names->items[i], err);
    if (st == CW_OK && s->files.count == 0)
        return cwi_fail(err, CW_ERR_FORMAT, "it holds no TIFF file");
    if (st == CW_OK && s->files.count < names->count)
        cwi_note(s->desc, "left out, because they are not TIFF: %zu of its files",
                 names->count - s->files.count);
    return st;
}

static size_t folder_length(const char *name)
{
    const char *slash = strrchr(name, '/');
    return slash ? (size_t)(slash - name) : 0;
}

/* Checks that all files are in one folder; a pattern may match in several. */
static cw_status check_folder(const slices *s, cw_error *err)
{
    const char *first = s->files.items[0];
    const size_t length = folder_length(first);
    if (cwi_files_is_pattern(s->in->path))
        return CW_OK;
    for (size_t i = 1; i < s->files.count; i++) {
        const char *name = s->files.items[i];
        if (folder_length(name) != length || memcmp(name, first, length) != 0)
            return cwi_fail(err, CW_ERR_UNSAFE,
                            "it has TIFF files in several folders, as are '%.80s' and '%.80s'; "
                            "name one of the folders, or a pattern",
                            first, name);
    }
    return CW_OK;
}

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
static cw_status look_into(slices *s, const char *name, bool first, cwi_tiff_facts *f,
                           cw_error *err)
{
    uint64_t size;
    int fd;
    cw_status st = cwi_input_open_side(s->in, name, &fd, &size, err);
    if (st != CW_OK)
        return st;
    cwi_free(first ? s->order : NULL);
    s->order = first ? NULL : s->order;
    st = take_facts(s->planes, fd, size, f, first ? &s->order : NULL, err);
    if (st == CW_OK && s->desc->skip_damaged && f->compressed)
        st = cwi_planes_try(s->planes, f->page_count, f->rows,
                            (size_t)f->columns * f->samples * cw_type_size(f->type), err);
    close(fd);
    if (st == CW_OK && first)
        s->facts = *f;
    return st;
}

/* Leaves a damaged file out if that was asked for. Reading it may have ended the library's
 * process. */
static cw_status leave_out(slices *s, cwi_damaged *damaged, const char *name,
                           const cw_error *reason, cw_error *err)
{
    cw_status st = cwi_damaged_add(damaged, name, "", reason, err);
    if (st == CW_OK && !s->desc->skip_damaged && s->files.count > 1)
        return cwi_damaged_fail(&damaged->items[0], err);
    return st == CW_OK && !s->planes->box.open ? cwi_planes_restart(s->planes, err) : st;
}

/* Reads the facts of every file, before any pixels. */
static cw_status look_into_all(slices *s, cw_error *err)
{
    cwi_damaged damaged = {0};
    cw_status st = CW_OK;
    size_t kept = 0;
    for (size_t i = 0; st == CW_OK && i < s->files.count; i++) {
        char *name = s->files.items[i];
        cwi_tiff_facts f;
        cw_error why = {0};
        s->planes->box.done = (double)i / (double)s->files.count;
        st = look_into(s, name, kept == 0, &f, &why);
        if (cwi_is_damage(st)) {
            st = leave_out(s, &damaged, name, &why, err);
            continue;
        }
        if (st != CW_OK)
            cwi_fail(err, st, "%s", why.message);
        else if (s->files.count > 1 && (st = check_alike(&s->facts, &f, err)) != CW_OK)
            cwi_fail_in(err, st, name);
        s->files.items[i] = s->files.items[kept];
        s->files.items[kept++] = name; /* those left out gather at the end */
    }
    if (st == CW_OK && kept == 0)
        st = cwi_fail(err, damaged.items[0].status, "%s: %s", damaged.items[0].name,
                      damaged.items[0].reason);
    if (st == CW_OK)
        cwi_damaged_note(&damaged, "left out, because they cannot be read", s->desc);
    cwi_damaged_free(&damaged);
    while (st == CW_OK && s->files.count > kept)
        cwi_free(s->files.items[--s->files.count]);
    return st;
}

/* Finds the positions: the numbers in which names differ, else 0, 1, 2 ... */
static cw_status find_positions(const slices *s, double *positions, cw_error *err)
{
    if (!cwi_files_numbers(&s->files, positions)) {
        for (size_t i = 0; i < s->files.count; i++)
            positions[i] = (double)i;
        cwi_note(s->desc, "the files' names do not differ by one number alone: taken in their "
                          "order, and whether any is missing is not known");
    }
    for (size_t i = 1; i < s->files.count; i++)
        if (positions[i] == positions[i - 1])
            return cwi_fail(err, CW_ERR_UNSAFE, "'%.80s' and '%.80s' have the same number",
                            s->files.items[i - 1], s->files.items[i]);
    return CW_OK;
}

static cw_status lay_slices(const slices *s, cwi_slices *laid, cw_error *err)
{
    double *positions = cwi_alloc_array(s->files.count, sizeof *positions);
    if (!positions)
        return cwi_fail_memory(err);
    cw_status st = find_positions(s, positions, err);
    if (st == CW_OK)
        st = cwi_slices_lay(positions, s->files.count, "in their numbers", s->desc->gaps, laid,
                            err);
    cwi_free(positions);
    if (st == CW_OK && laid->finding[0])
        cwi_note(s->desc, "%s: %s", laid->finding,
                 s->desc->gaps == CW_GAPS_ALLOW ? "taken as if they were even"
                                                : "interpolated to even ones");
    return st;
}

static cw_status stack_files(slices *s, cwi_stack *stack, cw_error *err)
{
    cwi_slices laid = {0};
    cw_status st = lay_slices(s, &laid, err);
    if (st == CW_OK)
        st = ensure_capacity(stack, s->files.count, laid.count, err);
    for (size_t i = 0; st == CW_OK && i < s->files.count; i++)
        stack->planes[i].file = i;
    for (size_t k = 0; st == CW_OK && k < laid.count; k++) {
        const cwi_slice *from = &laid.items[k];
        stack->slots[k] =
            (cwi_slot){.slice = k, .low = from->low, .high = from->high, .t = from->t};
    }
    if (st == CW_OK)
        set_sizes(&s->facts, laid.count, stack);
    cwi_slices_free(&laid);
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
        st = find_files(s, names, err);
        if (st == CW_OK)
            st = check_folder(s, err);
        if (st == CW_OK)
            st = look_into_all(s, err);
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
