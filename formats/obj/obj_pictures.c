/* Writes the pictures of textures beside an OBJ file, and the materials that name them. */
#define _GNU_SOURCE /* lstat */
#include "formats/obj/obj_pictures.h"

#include "core/base/memory.h"
#include "core/base/status.h"

#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { MAX_TRIES = 10000, BLOCK = 1 << 14 };

/* A picture, and the name of its file. */
typedef struct named_picture {
    const uint8_t *bytes;
    char *path;
} named_picture;

typedef struct picture_writer {
    cwi_mesh_output *out;
    const char *stem;
    size_t folder; /* bytes of the stem before the name */
    named_picture *names;
    size_t count;
} picture_writer;

size_t cwi_obj_textures(const cwi_parts *parts, const cwi_part *part)
{
    size_t number = 1;
    for (const cwi_part *p = parts->items; p->textures != part->textures; p++) {
        bool is_first = p->textures != NULL;
        for (const cwi_part *q = parts->items; q < p && is_first; q++)
            is_first = q->textures != p->textures;
        number += is_first;
    }
    return number;
}

static const char *extension_of(const cw_texture *picture)
{
    const uint8_t *b = picture->bytes;
    return picture->size > 2 && b[0] == 0xff && b[1] == 0xd8       ? "jpg"
           : picture->size > 12 && memcmp(b + 8, "WEBP", 4) == 0   ? "webp"
           : picture->size > 12 && memcmp(b, "\xabKTX 20", 7) == 0 ? "ktx2"
                                                                   : "png";
}

/* Finds what stands at a path: 0: nothing; 1: a file with these bytes; 2: something else. */
static int look_at(const char *path, const cw_texture *picture)
{
    struct stat info;
    uint8_t block[BLOCK];
    if (lstat(path, &info) != 0)
        return 0;
    if (!S_ISREG(info.st_mode) || (uint64_t)info.st_size != picture->size)
        return 2;
    const int fd = open(path, O_RDONLY | O_CLOEXEC);
    bool same = fd >= 0;
    for (size_t at = 0; same && at < picture->size;) {
        const ssize_t got = read(fd, block, sizeof block);
        same = got > 0 && (size_t)got <= picture->size - at &&
               memcmp(block, picture->bytes + at, (size_t)got) == 0;
        at += same ? (size_t)got : 0;
    }
    if (fd >= 0)
        close(fd);
    return same ? 1 : 2;
}

static bool is_taken(const picture_writer *w, const char *path)
{
    for (size_t n = 0; n < w->count; n++)
        if (strcmp(w->names[n].path, path) == 0)
            return true;
    return false;
}

/* Writes a picture under the first name that is free, unless it is there already. */
static cw_status write_picture(picture_writer *w, const cw_texture *picture, const char *use,
                               char *path, size_t capacity, cw_error *err)
{
    cwi_mesh_output *out = w->out;
    int found = 2;
    for (int n = 1; n < MAX_TRIES && found == 2; n++) {
        char number[16] = "";
        if (n > 1)
            snprintf(number, sizeof number, "_%d", n);
        snprintf(path, capacity, "%s_%s%s.%s", w->stem, use, number, extension_of(picture));
        found = is_taken(w, path) ? 2 : look_at(path, picture);
    }
    if (found == 1)
        return CW_OK;
    if (found == 2)
        return cwi_fail(err, CW_ERR_OUTPUT, "%s and %d more names of pictures are in use", path,
                        MAX_TRIES);
    cwi_outfile **files =
        cwi_realloc_array(out->pictures, out->picture_count + 1, sizeof *files);
    if (!files)
        return cwi_fail_memory(err);
    out->pictures = files;
    out->pictures[out->picture_count] = NULL;
    cw_status st = cwi_outfile_open(&out->pictures[out->picture_count], path, true, err);
    if (st != CW_OK)
        return cwi_fail_in(err, st, path);
    out->picture_count++;
    return cwi_outfile_write(out->pictures[out->picture_count - 1], picture->bytes,
                             picture->size, err);
}

/* Finds the name of a picture's file, which is written the first time. */
static cw_status name_picture(picture_writer *w, const cw_texture *picture, const char *use,
                              const char **name, cw_error *err)
{
    for (size_t n = 0; n < w->count; n++)
        if (w->names[n].bytes == picture->bytes) {
            *name = w->names[n].path + w->folder;
            return CW_OK;
        }
    const size_t capacity = strlen(w->stem) + 64;
    named_picture *names = cwi_realloc_array(w->names, w->count + 1, sizeof *names);
    if (names)
        w->names = names;
    char *path = names ? cwi_alloc_array(capacity, 1) : NULL;
    cw_status st =
        path ? write_picture(w, picture, use, path, capacity, err) : cwi_fail_memory(err);
    if (st != CW_OK) {
        cwi_free(path);
        return st;
    }
    w->names[w->count++] = (named_picture){picture->bytes, path};
    *name = path + w->folder;
    return CW_OK;
}

static double to_srgb(double c)
{
    return c <= 0.0031308 ? 12.92 * fmax(c, 0) : 1.055 * pow(fmin(c, 1), 1 / 2.4) - 0.055;
}

/* Writes the material of a set of textures. */
static cw_status write_set(picture_writer *w, size_t number, const cw_textures *set,
                           cw_error *err)
{
    const struct {
        const cw_texture *picture;
        const char *key, *use;
    } rows[] = {{&set->color, "map_Kd", "color"},
                {&set->normal, "norm", "normal"},
                {&set->emissive, "map_Ke", "emissive"}};
    double color[4] = {1, 1, 1, 1};
    for (int c = 0; c < 4 && set->has_factors; c++)
        color[c] = c < 3 ? to_srgb((double)set->color_factor[c]) : (double)set->color_factor[c];
    cwi_outfile *side = w->out->side;
    cw_status st =
        cwi_outfile_printf(side, err, "newmtl texture_%zu\nKd %.4f %.4f %.4f\nd %.4f\n", number,
                           color[0], color[1], color[2], color[3]);
    for (size_t n = 0; n < sizeof rows / sizeof *rows && st == CW_OK; n++) {
        const char *name = NULL;
        if (!rows[n].picture->bytes)
            continue;
        st = name_picture(w, rows[n].picture, rows[n].use, &name, err);
        if (st == CW_OK)
            st = cwi_outfile_printf(side, err, "%s %s\n", rows[n].key, name);
    }
    return st;
}

cw_status cwi_obj_write_textures(const cwi_parts *parts, cwi_mesh_output *out, const char *stem,
                                 cw_error *err)
{
    const char *slash = strrchr(stem, '/');
    picture_writer w = {
        .out = out, .stem = stem, .folder = slash ? (size_t)(slash - stem) + 1 : 0};
    size_t written = 0;
    cw_status st = CW_OK;
    for (size_t i = 0; i < parts->count && st == CW_OK; i++) {
        const cwi_part *part = &parts->items[i];
        if (!part->textures || cwi_obj_textures(parts, part) <= written)
            continue;
        st = write_set(&w, ++written, part->textures, err);
    }
    for (size_t n = 0; n < w.count; n++)
        cwi_free(w.names[n].path);
    cwi_free(w.names);
    return st;
}
