/* Interprets the description of a TIFF file's pages: reads ImageJ's lines here, and passes
 * OME's XML on. */
#include "core/base/status.h"
#include "core/base/text.h"
#include "formats/tiff/tiff_file.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

/* --- ImageJ ------------------------------------------------------------------------------- */

/* Finds the rest of the line KEY=; returns NULL if there is none. */
static const char *find_line(const char *text, const char *key, size_t *length)
{
    const size_t size = strlen(key);
    for (const char *line = text; *line; line += *line == '\n') {
        *length = strcspn(line, "\r\n");
        if (*length > size && memcmp(line, key, size) == 0 && line[size] == '=') {
            *length -= size + 1;
            return line + size + 1;
        }
        line += strcspn(line, "\n");
    }
    return NULL;
}

static bool find_number(const char *text, const char *key, double *value)
{
    size_t length;
    const char *at = find_line(text, key, &length);
    return at && cwi_parse_double(&at, value) && isfinite(*value);
}

static cw_status find_count(const char *text, const char *key, uint32_t *count, cw_error *err)
{
    double value;
    if (!find_number(text, key, &value))
        return CW_OK;
    if (!(value >= 1) || value > CWI_TIFF_MAX_PAGES || value != floor(value))
        return cwi_fail(err, CW_ERR_FORMAT,
                        "'ImageDescription' says %s=%.6g; it must be 1 to %d", key, value,
                        CWI_TIFF_MAX_PAGES);
    *count = (uint32_t)value;
    return CW_OK;
}

static bool is_one_run(const cwi_tiff_file *f)
{
    const cwi_tiff_layout *l = &f->layout;
    const uint64_t start = TIFFGetStrileOffset(f->tiff, 0);
    if (f->offset_count > 1 || l->tiled || l->compression != COMPRESSION_NONE || l->planes > 1)
        return false;
    for (uint32_t s = 0; s < l->bands; s++)
        if (TIFFGetStrileOffset(f->tiff, s) !=
            start + (uint64_t)s * l->band_rows * l->stored_row)
            return false;
    return true;
}

cw_status cwi_tiff_find_images(cwi_tiff_file *f, uint32_t images, cw_error *err)
{
    const cwi_tiff_layout *l = &f->layout;
    uint64_t bytes = (uint64_t)l->rows * l->stored_row; /* below 2^57 */
    if (images == f->page_count)
        return CW_OK;
    if (f->page_count > 1 || !is_one_run(f))
        return cwi_fail(err, CW_ERR_FORMAT,
                        "'ImageDescription' says images=%u; the file holds %u pages", images,
                        f->page_count);
    const uint64_t start = TIFFGetStrileOffset(f->tiff, 0);
    if (__builtin_mul_overflow(bytes, images, &bytes) || bytes > f->size - start)
        return cwi_fail(
            err, CW_ERR_FORMAT,
            "'ImageDescription' says images=%u, which would be %llu bytes; the file "
            "has %llu behind the first %llu",
            images, (unsigned long long)bytes, (unsigned long long)(f->size - start),
            (unsigned long long)start);
    if (f->offsets[0] >= start && f->offsets[0] < start + bytes)
        return cwi_fail(
            err, CW_ERR_FORMAT,
            "'ImageDescription' says images=%u, which would be %llu bytes behind the "
            "first %llu; the file's directory is among those",
            images, (unsigned long long)bytes, (unsigned long long)start);
    f->behind = start;
    f->page_count = images;
    return CW_OK;
}

/* Reads the order of the axes, the fastest first: 'czt', where nothing else is stated. The axes of a
 * plane may stand in front. */
static cw_status read_order(const char *text, char letters[4], cw_error *err)
{
    size_t length;
    const char *line = find_line(text, "order", &length);
    unsigned seen = 0;
    strcpy(letters, "czt");
    if (!line || length == 0 || (length == 7 && strncasecmp(line, "default", 7) == 0))
        return CW_OK;
    const char *order = line;
    if (length == 5 && strncasecmp(line, "xy", 2) == 0)
        order += 2;
    for (size_t i = 0; i < 3 && order + i < line + length; i++) {
        letters[i] = (char)(order[i] | 0x20);
        seen |= letters[i] == 'c' ? 1u : letters[i] == 'z' ? 2u : letters[i] == 't' ? 4u : 0u;
    }
    if (seen == 7 && order + 3 == line + length)
        return CW_OK;
    return cwi_fail(err, CW_ERR_FORMAT,
                    "'ImageDescription' says order=%.*s; c, z and t were expected, such as czt",
                    (int)(length < 20 ? length : 20), line);
}

/* Orders the pages as the file states, else as channel, slice, frame. Missing counts are 1, and slices
 * take the rest. */
static cw_status order_images(const cwi_tiff_file *f, const char *text, cwi_tiff_facts *facts,
                              uint32_t *order, cw_error *err)
{
    uint32_t c = 1, z = 0, t = 1;
    char letters[4];
    cw_status st = read_order(text, letters, err);
    if (st == CW_OK)
        st = find_count(text, "channels", &c, err);
    if (st == CW_OK)
        st = find_count(text, "slices", &z, err);
    if (st == CW_OK)
        st = find_count(text, "frames", &t, err);
    if (st != CW_OK)
        return st;
    if (z == 0)
        z = (uint32_t)(f->page_count / ((uint64_t)c * t));
    if ((uint64_t)c * t > CWI_TIFF_MAX_PAGES || (uint64_t)c * t * z != f->page_count)
        return cwi_fail(
            err, CW_ERR_FORMAT,
            "'ImageDescription' says %u channels, %u slices and %u frames; the file "
            "holds %u images",
            c, z, t, f->page_count);
    facts->channels = c;
    facts->slices = z;
    facts->steps = t;
    for (uint32_t p = 0; p < f->page_count; p++) {
        uint32_t rest = p, at[3] = {0}; /* c, z, t */
        for (int i = 0; i < 3; i++) {
            const int axis = letters[i] == 'c' ? 0 : letters[i] == 'z' ? 1 : 2;
            const uint32_t size = axis == 0 ? c : axis == 1 ? z : t;
            at[axis] = rest % size;
            rest /= size;
        }
        order[(at[2] * c + at[0]) * z + at[1]] = p;
    }
    return CW_OK;
}

/* Finds the pixels per unit; in files that ImageJ has not calibrated it is 72 per inch. */
static void find_pixels(const cwi_tiff_file *f, const char *text, cwi_tiff_facts *facts)
{
    static const char *const keys[] = {"unit", "yunit", "zunit"};
    uint16_t resolution = RESUNIT_NONE;
    double value;
    size_t length;
    TIFFGetFieldDefaulted(f->tiff, TIFFTAG_RESOLUTIONUNIT, &resolution);
    const char *name = resolution == RESUNIT_INCH         ? "inch"
                       : resolution == RESUNIT_CENTIMETER ? "cm"
                                                          : "";
    for (int a = 0; a < 3; a++) {
        const char *line = find_line(text, keys[a], &length);
        line = line ? line : find_line(text, keys[0], &length);
        cwi_tiff_set_unit(facts, a, line ? line : name, line ? length : strlen(name));
    }
    for (int a = 0; a < 2; a++)
        if (cwi_tiff_rational(f, a ? TIFFTAG_YRESOLUTION : TIFFTAG_XRESOLUTION, &value) &&
            value > 0 && isfinite(value) && (value != 72 || resolution != RESUNIT_INCH))
            facts->spacing[a] = 1 / value;
    const bool stated = find_number(text, "spacing", &value) && value != 0;
    facts->spacing[2] = stated ? fabs(value) : facts->slices > 1 ? 1 : 0;
    if (!stated && facts->slices > 1 && facts->spacing[0] > 0 && facts->unit_mm[2] > 0)
        cwi_tiff_note(facts,
                      "ImageJ's description has no 'spacing' of slices, which stands for 1");
}

static void find_values(const char *text, cwi_tiff_facts *facts)
{
    double interval, function, c0, c1;
    size_t length;
    const char *name = find_line(text, "tunit", &length);
    if (find_number(text, "finterval", &interval) && interval > 0)
        facts->step_seconds = interval * (name ? cwi_tiff_time(name, length) : 1);
    if (!find_number(text, "cf", &function))
        return;
    if (function == 0 && find_number(text, "c0", &c0) && find_number(text, "c1", &c1) &&
        c1 != 0) {
        facts->slope = c1;
        facts->intercept = c0;
    } else {
        cwi_tiff_note(facts,
                      "ImageJ's calibration by function %.6g is left out: values are as stored",
                      function);
    }
}

static cw_status describe_imagej(cwi_tiff_file *f, const char *text, cwi_tiff_facts *facts,
                                 uint32_t *order, cw_error *err)
{
    uint32_t images = f->page_count;
    cw_status st = find_count(text, "images", &images, err);
    if (st == CW_OK)
        st = cwi_tiff_find_images(f, images, err);
    if (st == CW_OK)
        st = order_images(f, text, facts, order, err);
    if (st != CW_OK)
        return st;
    find_pixels(f, text, facts);
    find_values(text, facts);
    return CW_OK;
}

/* --- kinds of descriptions ---------------------------------------------------------------- */

/* Finds the size of pixels by the tags of resolution. Programs that know none write 72 or 96 per
 * inch, or 1. */
static void find_resolution(const cwi_tiff_file *f, cwi_tiff_facts *facts)
{
    enum { SCREEN = 72, OTHER_SCREEN = 96 };
    uint16_t unit = RESUNIT_NONE;
    double per_unit[2];
    TIFFGetFieldDefaulted(f->tiff, TIFFTAG_RESOLUTIONUNIT, &unit);
    const double unit_mm = unit == RESUNIT_INCH ? 25.4 : unit == RESUNIT_CENTIMETER ? 10 : 0;
    for (int a = 0; a < 2; a++)
        if (!cwi_tiff_rational(f, a ? TIFFTAG_YRESOLUTION : TIFFTAG_XRESOLUTION,
                               &per_unit[a]) ||
            !(per_unit[a] > 1) || !isfinite(per_unit[a]) ||
            (unit == RESUNIT_INCH && (per_unit[a] == SCREEN || per_unit[a] == OTHER_SCREEN)))
            return;
    for (int a = 0; a < 2; a++)
        facts->pixel_mm[a] = unit_mm / per_unit[a];
}

static bool is_ome(const char *text)
{
    return *text == '<' && (strstr(text, "<OME") || strstr(text, ":OME "));
}

cw_status cwi_tiff_describe(cwi_tiff_file *f, const char *text, uint32_t image,
                            cwi_tiff_facts *facts, uint32_t *order, cw_error *err)
{
    if (strncmp(text, "\xef\xbb\xbf", 3) == 0)
        text += 3;
    text += strspn(text, " \t\r\n");
    if (strncmp(text, "ImageJ=", 7) == 0)
        return describe_imagej(f, text, facts, order, err);
    if (is_ome(text))
        return cwi_tiff_ome(f, text, image, facts, order, err);
    find_resolution(f, facts);
    if (*text == '{' && strstr(text, "\"shape\""))
        return cwi_tiff_shaped(f, text, facts, order, err);
    facts->slices = f->page_count;
    facts->channels = facts->steps = 1;
    for (uint32_t p = 0; p < f->page_count; p++)
        order[p] = p;
    return CW_OK;
}
