/* Reads the colours of Wavefront materials (.mtl). */
#include "formats/obj/obj_materials.h"

#include "core/base/memory.h"
#include "core/base/status.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Maximums that no true file reaches: each file is read once and sorted. */
enum { MAX_FILES = 64, MAX_BYTES = 64 << 20 };

uint8_t cwi_obj_color(double number, double scale)
{
    return (uint8_t)lround(255 * fmin(fmax(isnan(number) ? 0 : number * scale, 0), 1));
}

static int compare_names(const void *a, const void *b)
{
    const cwi_obj_material *s = a, *t = b;
    const int order = strcmp(s->text, t->text);
    return order ? order : (s->order > t->order) - (s->order < t->order);
}

static cw_status add_material(cwi_obj_materials *m, const char *name, cw_error *err)
{
    const size_t length = strlen(name) + 1;
    cw_status st =
        cwi_mesh_grow(m->in, &m->items, &m->capacity, m->count + 1, sizeof *m->items, err);
    if (st == CW_OK)
        st = cwi_mesh_grow(m->in, &m->names, &m->name_capacity, m->name_bytes + length, 1, err);
    if (st != CW_OK)
        return st;
    m->items[m->count] = (cwi_obj_material){
        .name = m->name_bytes, .order = m->count, .color = {255, 255, 255, 255}};
    m->count++;
    memcpy(m->names + m->name_bytes, name, length);
    m->name_bytes += length;
    return CW_OK;
}

/* Reads up to three numbers, and counts them. One alone counts for all three. A word, as of a spectral
 * curve, is not read. */
static cw_status read_numbers(cwi_scan *s, double number[3], int *count, cw_error *err)
{
    cwi_word word;
    cw_status st = cwi_scan_word(s, &word, err);
    for (*count = 0; st == CW_OK && *count < 3 && cwi_word_double(&word, &number[*count]);) {
        ++*count;
        st = cwi_scan_word(s, &word, err);
    }
    for (int c = *count; *count > 0 && c < 3; c++)
        number[c] = number[0];
    return st;
}

static cw_status read_line(cwi_obj_materials *m, size_t first, cwi_scan *s, cw_error *err)
{
    char name[CWI_REST_BYTES];
    double number[3] = {0};
    int count = 0;
    cwi_word word;
    cw_status st = cwi_scan_word(s, &word, err);
    if (st == CW_OK && cwi_word_is(&word, "newmtl")) {
        st = cwi_scan_rest(s, name, err);
        return st == CW_OK ? add_material(m, name, err) : st;
    }
    if (st != CW_OK || m->count == first)
        return st;
    cwi_obj_material *material = &m->items[m->count - 1];
    const bool is_color = cwi_word_is(&word, "Kd"), is_opacity = cwi_word_is(&word, "d"),
               is_transparency = cwi_word_is(&word, "Tr");
    material->has_texture = material->has_texture || cwi_word_is(&word, "map_Kd");
    if (is_color || is_opacity || is_transparency)
        st = read_numbers(s, number, &count, err);
    for (int c = 0; c < 3 && is_color && count; c++)
        material->color[c] = cwi_obj_color(number[c], 1);
    material->has_color = material->has_color || (is_color && count);
    if ((is_opacity || is_transparency) && count)
        material->color[3] = cwi_obj_color(is_opacity ? number[0] : 1 - number[0], 1);
    return st;
}

static cw_status read_lines(cwi_obj_materials *m, const cwi_input *file, cw_error *err)
{
    const size_t first = m->count;
    cwi_scan s = {0};
    bool found = false;
    cw_status st = cwi_scan_open_text(&s, file, 0, &m->in->desc.progress, err);
    s.by_line = s.comments = true;
    if (st == CW_OK)
        st = cwi_scan_next_line(&s, &found, err);
    while (st == CW_OK && found) {
        st = read_line(m, first, &s, err);
        if (st == CW_OK)
            st = cwi_scan_end_line(&s, err);
        if (st == CW_OK)
            st = cwi_scan_next_line(&s, &found, err);
    }
    cwi_scan_close(&s);
    return st;
}

cw_status cwi_obj_read_materials(cwi_obj_materials *m, const char *name, cw_error *err)
{
    cwi_input file = m->in->file;
    cw_status st = CW_OK;
    int fd = -1;
    if (m->files++ < MAX_FILES)
        st = cwi_input_open_side(&m->in->file, name, &fd, &file.size, err);
    const bool opens = st == CW_OK && fd >= 0;
    file.fd = fd;
    if (opens && file.size <= MAX_BYTES)
        st = read_lines(m, &file, err);
    else
        m->is_missing = true;
    if (opens)
        close(fd);
    if (st == CW_ERR_FORMAT || st == CW_ERR_IO || st == CW_ERR_UNSAFE) {
        m->is_missing = true;
        st = CW_OK;
    }
    for (size_t i = 0; i < m->count; i++)
        m->items[i].text = m->names + m->items[i].name;
    if (m->count)
        qsort(m->items, m->count, sizeof *m->items, compare_names);
    return st;
}

const cwi_obj_material *cwi_obj_find_material(const cwi_obj_materials *m, const char *name)
{
    size_t low = 0, high = m->count;
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (strcmp(m->names + m->items[middle].name, name) < 0)
            low = middle + 1;
        else
            high = middle;
    }
    return low < m->count && strcmp(m->names + m->items[low].name, name) == 0 ? &m->items[low]
                                                                              : NULL;
}

void cwi_obj_materials_free(cwi_obj_materials *m)
{
    cwi_free(m->items);
    cwi_free(m->names);
    *m = (cwi_obj_materials){0};
}
