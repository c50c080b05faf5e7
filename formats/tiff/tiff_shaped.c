/* Reads tifffile's description of pages: an object of JSON with the 'shape' of the whole array, and
 * possibly the names of its 'axes'. */
#include "core/base/status.h"
#include "core/base/text.h"
#include "formats/tiff/tiff_file.h"

#include <stdio.h>
#include <string.h>

enum { MAX_AXES = 16 };

/* The leading axes: those in front of a page's own, the slowest first. */
typedef struct shape {
    size_t count;
    int64_t size[MAX_AXES];
    char letter[MAX_AXES + 1]; /* 0: not named */
} shape;

/* Finds the value of a key; NULL: there is none. */
static const char *find_value(const char *json, const char *key)
{
    const char *at = strstr(json, key);
    if (!at)
        return NULL;
    at += strlen(key);
    at += strspn(at, " \t\r\n");
    return *at == ':' ? at + 1 + strspn(at + 1, " \t\r\n") : NULL;
}

static cw_status fail_shape(const char *json, cw_error *err)
{
    return cwi_fail(err, CW_ERR_FORMAT,
                    "'ImageDescription' is '%.60s'; the 'shape' of tifffile was expected to be "
                    "1 to %d sizes",
                    json, MAX_AXES);
}

static cw_status read_shape(const char *json, shape *s, cw_error *err)
{
    const char *at = find_value(json, "\"shape\"");
    if (!at || *at++ != '[')
        return fail_shape(json, err);
    for (at += strspn(at, " "); *at != ']'; at += strspn(at, ", ")) {
        if (s->count == MAX_AXES || !cwi_parse_int(&at, &s->size[s->count]) ||
            s->size[s->count] < 1 || s->size[s->count] > INT32_MAX)
            return fail_shape(json, err);
        s->count++;
    }
    const char *axes = find_value(json, "\"axes\"");
    if (axes && *axes == '"' && strcspn(axes + 1, "\"") == s->count)
        memcpy(s->letter, axes + 1, s->count);
    return s->count ? CW_OK : fail_shape(json, err);
}

/* Takes the axes of a page itself off. Returns false where they are not those of the pages. */
static bool take_page(const cwi_tiff_file *f, shape *s)
{
    const cwi_tiff_layout *l = &f->layout;
    const bool is_apart = l->planes > 1;
    const int64_t all[4] = {is_apart ? l->samples : 1, l->rows, l->columns,
                            is_apart ? 1 : l->samples};
    for (int i = 3; i >= 0; i--) {
        if (i == 3 && all[i] == 1 && s->count > 2 && s->size[s->count - 1] == 1 &&
            l->columns > 1)
            s->count--; /* a sample by itself */
        if (all[i] == 1 && (i == 0 || i == 3))
            continue;
        if (s->count == 0 || s->size[s->count - 1] != all[i])
            return false;
        s->count--;
    }
    return true;
}

/* Leaves axes of one page out. */
static void drop_single(shape *s)
{
    size_t kept = 0;
    for (size_t n = 0; n < s->count; n++)
        if (s->size[n] > 1) {
            s->size[kept] = s->size[n];
            s->letter[kept++] = s->letter[n];
        }
    s->count = kept;
}

typedef enum role { SLICE, CHANNEL, STEP, ROLES } role;

/* Finds the role of a leading axis: by its name, else the last one is that of slices. */
static role role_of(const shape *s, size_t n)
{
    const char letter = s->letter[n];
    if (letter == 'Z' || letter == 'C' || letter == 'T')
        return letter == 'Z' ? SLICE : letter == 'C' ? CHANNEL : STEP;
    return n + 1 == s->count ? SLICE : STEP;
}

/* Places the pages; axes of one role are one after another. */
static void place_pages(const shape *s, cwi_tiff_facts *facts, uint32_t *order, uint32_t pages)
{
    uint32_t sizes[ROLES] = {1, 1, 1};
    for (size_t n = 0; n < s->count; n++)
        sizes[role_of(s, n)] *= (uint32_t)s->size[n];
    facts->slices = sizes[SLICE];
    facts->channels = sizes[CHANNEL];
    facts->steps = sizes[STEP];
    for (uint32_t p = 0; p < pages; p++) {
        uint32_t rest = p, at[ROLES] = {0}, stride[ROLES] = {1, 1, 1};
        for (size_t n = s->count; n > 0; n--) {
            const uint32_t size = (uint32_t)s->size[n - 1];
            const role r = role_of(s, n - 1);
            at[r] += rest % size * stride[r];
            stride[r] *= size;
            rest /= size;
        }
        order[(at[STEP] * sizes[CHANNEL] + at[CHANNEL]) * sizes[SLICE] + at[SLICE]] = p;
    }
}

static void note_roles(const shape *s, cwi_tiff_facts *facts)
{
    char steps[32] = "", channels[40] = "";
    if (facts->steps > 1)
        snprintf(steps, sizeof steps, "%u steps of ", facts->steps);
    if (facts->channels > 1)
        snprintf(channels, sizeof channels, "%u components of ", facts->channels);
    cwi_tiff_note(facts, "tifffile's 'shape' has %zu axes of pages: taken as %s%s%u slices",
                  s->count, steps, channels, facts->slices);
}

static void take_as_slices(uint32_t pages, cwi_tiff_facts *facts, uint32_t *order)
{
    facts->slices = pages;
    facts->channels = facts->steps = 1;
    for (uint32_t p = 0; p < pages; p++)
        order[p] = p;
}

cw_status cwi_tiff_shaped(cwi_tiff_file *f, const char *json, cwi_tiff_facts *facts,
                          uint32_t *order, cw_error *err)
{
    shape s = {0};
    uint64_t pages = 1;
    cw_status st = read_shape(json, &s, err);
    if (st != CW_OK)
        return st;
    const bool is_of_pages = take_page(f, &s);
    drop_single(&s);
    for (size_t n = 0; n < s.count && pages <= CWI_TIFF_MAX_PAGES; n++)
        pages *= (uint64_t)s.size[n];
    if (is_of_pages && pages > f->page_count && pages <= CWI_TIFF_MAX_PAGES &&
        f->page_count == 1)
        st = cwi_tiff_find_images(f, (uint32_t)pages, err);
    if (st != CW_OK)
        return st;
    if (!is_of_pages || pages > f->page_count) {
        take_as_slices(f->page_count, facts, order);
        cwi_tiff_note(
            facts,
            "the 'shape' in 'ImageDescription' is not that of the %u pages, which are "
            "taken as slices",
            f->page_count);
        return CW_OK;
    }
    place_pages(&s, facts, order, (uint32_t)pages);
    if (pages < f->page_count)
        cwi_tiff_note(facts, "left out: %u pages that the first 'shape' does not count",
                      f->page_count - (uint32_t)pages);
    if (s.count > 1)
        note_roles(&s, facts);
    return CW_OK;
}
