/* Reads the colours of Wavefront materials (.mtl). */
#include "formats/obj/obj_materials.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"

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

/* --- pictures ------------------------------------------------------------------------------ */

/* Options before the name of a picture, and how many words follow each. Numbers follow a placing: one to
 * three of them. */
static const struct {
    const char *name;
    int words;
    bool is_placing;
} map_options[] = {
    {"-blendu", 1, false}, {"-blendv", 1, false}, {"-boost", 1, false},   {"-bm", 1, false},
    {"-cc", 1, false},     {"-clamp", 1, false},  {"-imfchan", 1, false}, {"-mm", 2, false},
    {"-o", 3, true},       {"-s", 3, true},       {"-t", 3, true},        {"-texres", 1, false},
    {"-type", 1, false},
};

/* Skips a word and the blanks behind it. */
static const char *skip_word(const char *at)
{
    at += strcspn(at, " \t");
    return at + strspn(at, " \t");
}

static bool is_number(const char *at)
{
    double number;
    return cwi_parse_double(&at, &number) && (*at == '\0' || *at == ' ' || *at == '\t');
}

/* Returns the name behind the options of a line of a picture. */
static const char *skip_options(cwi_obj_materials *m, const char *at)
{
    while (*at == '-') {
        const size_t length = strcspn(at, " \t");
        size_t n = 0;
        while (n < sizeof map_options / sizeof *map_options &&
               (strlen(map_options[n].name) != length ||
                strncmp(map_options[n].name, at, length) != 0))
            n++;
        if (n == sizeof map_options / sizeof *map_options)
            break;
        m->has_options = m->has_options || map_options[n].is_placing;
        at = skip_word(at);
        for (int word = 0; word < map_options[n].words && *at; word++)
            if (!map_options[n].is_placing || is_number(at))
                at = skip_word(at);
    }
    return at;
}

/* Returns the picture of a material that a key names; NULL for a key of another kind. */
static cw_texture *find_picture(cwi_obj_material *m, const cwi_word *key)
{
    const bool is_normal = cwi_word_is(key, "norm"), is_bump = cwi_word_is(key, "map_Bump") ||
                                                               cwi_word_is(key, "map_bump") ||
                                                               cwi_word_is(key, "bump");
    if (is_normal || (is_bump && !m->has_normal_map)) {
        m->has_normal_map = is_normal;
        return &m->set.normal;
    }
    return cwi_word_is(key, "map_Kd")   ? &m->set.color
           : cwi_word_is(key, "map_Ke") ? &m->set.emissive
                                        : NULL;
}

static bool is_other_picture(const cwi_word *key)
{
    return (key->size > 4 && memcmp(key->text, "map_", 4) == 0) || cwi_word_is(key, "disp") ||
           cwi_word_is(key, "decal") || cwi_word_is(key, "refl");
}

static cw_status read_picture(cwi_obj_materials *m, cw_texture *picture, cwi_scan *s,
                              cw_error *err)
{
    char line[CWI_REST_BYTES];
    cw_status st = cwi_scan_rest(s, line, err);
    if (st != CW_OK || !m->in->pictures.is_wanted)
        return st;
    return cwi_picture_read(m->in, skip_options(m, line), picture, err);
}

/* Adds the pictures of materials from `first` on to those of the file. */
static cw_status add_textures(cwi_obj_materials *m, size_t first, cw_error *err)
{
    cw_status st = CW_OK;
    for (size_t n = first; n < m->count && st == CW_OK; n++) {
        m->items[n].set.repeats = true;
        st = cwi_textures_add(m->in, &m->items[n].set, &m->items[n].textures, err);
    }
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
    cw_texture *picture = find_picture(material, &word);
    if (picture)
        return read_picture(m, picture, s, err);
    m->has_others = m->has_others || is_other_picture(&word);
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
    return st == CW_OK ? add_textures(m, first, err) : st;
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
    if (st == CW_ERR_FORMAT || st == CW_ERR_IO || st == CW_ERR_UNSAFE ||
        st ==
            CW_ERR_UNSUPPORTED) { /* unsupported: bytes without a path have no files beside them */
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
