/* Reads slices in PNG or BMP files, one in each. */
#include "formats/picture/picture.h"

#include "core/base/status.h"
#include "formats/picture/picture_format.h"
#include "formats/volume/slice_files.h"

#include <math.h>
#include <string.h>

typedef struct pictures {
    const cwi_input *in;
    cwi_planes *planes;
    const cw_read_desc *desc;
    cwi_names files;
    cwi_picture_facts facts, last; /* of the first file, of the last one */
} pictures;

bool cwi_png_sniff(const unsigned char *head, size_t size)
{
    return size >= 8 && memcmp(head, "\x89PNG\r\n\x1a\n", 8) == 0;
}

/* Two letters decide little, so the sizes behind them have to be possible as well. */
bool cwi_bmp_sniff(const unsigned char *head, size_t size)
{
    static const unsigned char sizes[] = {12, 40, 52, 56, 64, 108, 124};
    return size >= 26 && memcmp(head, "BM", 2) == 0 && memchr(sizes, head[14], sizeof sizes) &&
           !head[15] && !head[16] && !head[17];
}

/* Checks the facts, which are untrusted: libpng's process may have been taken over. */
static cw_status check_facts(const cwi_picture_facts *f, uint64_t file_bytes, cw_error *err)
{
    if (f->columns < 1 || f->columns > INT32_MAX || f->rows < 1 || f->rows > INT32_MAX ||
        f->samples < 1 || f->samples > CWI_PICTURE_SAMPLES || f->bits < 1 || f->bits > 16 ||
        (f->type != CW_U8 && f->type != CW_U16) || f->max_ratio < 1 || f->max_ratio > 65536 ||
        !isfinite(f->pixel_mm[0]) || !isfinite(f->pixel_mm[1]))
        return cwi_fail(err, CW_ERR_BACKEND, "libpng's answer is not valid");
    const uint64_t row = ((uint64_t)f->columns * f->samples * f->bits + 7) / 8; /* < 2^34 */
    if (row / f->max_ratio > file_bytes / f->rows)
        return cwi_fail(err, CW_ERR_FORMAT, "%u x %u pixels are more than %llu bytes can hold",
                        f->columns, f->rows, (unsigned long long)file_bytes);
    if ((uint64_t)f->columns * f->samples * cw_type_size(f->type) > CWI_PLANES_SHARED)
        return cwi_fail(err, CW_ERR_LIMIT, "a row of %u pixels takes more than %d bytes",
                        f->columns, CWI_PLANES_SHARED);
    return CW_OK;
}

static cw_status take_facts(pictures *p, int fd, uint64_t size, cwi_picture_facts *f,
                            cw_error *err)
{
    const void *shared;
    cw_status st = cwi_planes_facts(p->planes, fd, size, &shared, err);
    if (st != CW_OK)
        return st;
    memcpy(f, shared, sizeof *f);
    return check_facts(f, size, err);
}

static cw_status look_into(void *user, int fd, uint64_t size, bool is_first, cw_error *err)
{
    pictures *p = user;
    cwi_picture_facts *f = &p->last;
    cw_status st = take_facts(p, fd, size, f, err);
    if (st == CW_OK && p->desc->skip_damaged)
        st = cwi_planes_try(p->planes, 1, f->rows,
                            (size_t)f->columns * f->samples * cw_type_size(f->type), err);
    if (st == CW_OK && is_first)
        p->facts = *f;
    return st;
}

static cw_status compare_last(void *user, cw_error *err)
{
    const cwi_picture_facts *a = &((pictures *)user)->facts, *b = &((pictures *)user)->last;
    if (a->columns == b->columns && a->rows == b->rows && a->samples == b->samples &&
        a->type == b->type && !a->has_palette == !b->has_palette)
        return CW_OK;
    return cwi_fail(err, CW_ERR_FORMAT,
                    "it is %u x %u, %u x %s%s; the first is %u x %u, %u x %s%s", b->columns,
                    b->rows, b->samples, cw_type_name(b->type),
                    b->has_palette ? " of a palette" : "", a->columns, a->rows, a->samples,
                    cw_type_name(a->type), a->has_palette ? " of a palette" : "");
}

static void set_shape(const cwi_picture_facts *f, size_t slices, cwi_stack *stack)
{
    cw_volume *v = &stack->shape;
    const ptrdiff_t size = (ptrdiff_t)cw_type_size(f->type);
    stack->size_field = "width, height";
    stack->type = v->type = f->type;
    stack->samples = v->components = f->samples;
    v->slope = 1;
    v->dim[0] = f->columns;
    v->dim[1] = f->rows;
    v->dim[2] = slices;
    v->steps = 1;
    v->component_stride = size;
    v->stride[0] = size * (ptrdiff_t)f->samples;
    v->stride[1] = v->stride[0] * (ptrdiff_t)f->columns;
    v->stride[2] = v->stride[1] * (ptrdiff_t)f->rows;
    v->step_stride = v->stride[2] * (ptrdiff_t)slices;
    for (int a = 0; a < 3; a++)
        v->affine[a][a] = 1;
}

static void note_facts(const cwi_picture_facts *f, const cw_read_desc *desc)
{
    if (f->has_palette)
        cwi_note(desc, "the palette has colours: values are their numbers in it");
    if (f->pixel_mm[0] > 0 && !(desc->spacing_mm[0] > 0))
        cwi_note(desc,
                 "'pHYs' states pixels of %.6g x %.6g mm, which may be for print: they are not "
                 "used; desc->spacing_mm states what is so",
                 f->pixel_mm[0], f->pixel_mm[1]);
}

/* Stacks the files, or the open file by itself. */
static cw_status find_stack(pictures *p, const cwi_slice_kind *kind, const cwi_names *names,
                            cwi_stack *stack, cw_error *err)
{
    size_t count = 1;
    cw_status st = CW_OK;
    if (names) {
        st = cwi_slice_files_find(kind, p->in, names, p->desc, &p->files, err);
        if (st == CW_OK)
            st = cwi_slice_files_look(kind, p->in, p->planes, p->desc, &p->files, err);
        if (st == CW_OK)
            st = cwi_slice_files_stack(&p->files, p->desc, stack, &count, err);
    } else {
        st = take_facts(p, p->in->fd, p->in->size, &p->facts, err);
        if (st == CW_OK)
            st = cwi_stack_reserve(stack, 1, 1, err);
    }
    if (st == CW_OK)
        set_shape(&p->facts, count, stack);
    return st;
}

static cw_status read_pictures(const cwi_input *in, cwi_names *names, cwi_slice_kind *kind,
                               const cw_read_desc *desc, cw_volume *volume, cw_error *err)
{
    cwi_planes planes = {0};
    cwi_stack stack = {0};
    pictures p = {.in = in, .planes = &planes, .desc = desc};
    kind->look = look_into;
    kind->compare = compare_last;
    kind->user = &p;
    cw_status st = cwi_planes_open(&planes, "picture", "libpng", desc, err);
    if (st == CW_OK)
        st = find_stack(&p, kind, names, &stack, err);
    if (st == CW_OK) {
        note_facts(&p.facts, desc);
        cwi_set_spacing(&stack.shape, desc);
        stack.files = p.files;
        p.files = (cwi_names){0};
        st = cwi_stack_load(&stack, in, &planes, desc, volume, err);
    }
    cwi_names_free(&p.files);
    cwi_stack_free(&stack);
    cwi_planes_close(&planes);
    return st;
}

cw_status cwi_png_read(const cwi_input *in, cwi_names *names, const cw_read_desc *desc,
                       cw_volume *volume, cw_error *err)
{
    cwi_slice_kind kind = {.name = "PNG", .extensions = ".png", .sniff = cwi_png_sniff};
    return read_pictures(in, names, &kind, desc, volume, err);
}

cw_status cwi_bmp_read(const cwi_input *in, cwi_names *names, const cw_read_desc *desc,
                       cw_volume *volume, cw_error *err)
{
    cwi_slice_kind kind = {.name = "BMP", .extensions = ".bmp", .sniff = cwi_bmp_sniff};
    return read_pictures(in, names, &kind, desc, volume, err);
}
