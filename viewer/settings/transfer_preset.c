/* Makes preset transfer functions. Those for CT stand at Hounsfield units, per millimetre. The
 * others are fitted to the histogram, per voxel. Colours and opacities were chosen by looking
 * at scans. */
#include <cubewright/transfer.h>

#include "core/base/status.h"
#include "core/color/colormap.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static void put_color(cw_transfer *t, double value, unsigned rgb)
{
    cw_color_point *p = &t->colors[t->color_count++];
    p->value = value;
    for (int c = 0; c < 3; c++)
        p->color[c] = (float)(rgb >> (16 - 8 * c) & 255) / 255;
}

static void put_opacity(cw_transfer *t, double value, double opacity)
{
    t->opacities[t->opacity_count++] = (cw_opacity_point){value, (float)opacity};
}

/* Returns the value below which a fraction of the values lie, counted from a bin on. */
static double find_quantile(const cw_statistics *s, size_t first, double fraction)
{
    double total = 0, sum = 0;
    for (size_t b = first; b < s->bin_count; b++)
        total += (double)s->bins[b];
    for (size_t b = first; b < s->bin_count; b++) {
        const double count = (double)s->bins[b];
        if (count > 0 && sum + count >= fraction * total)
            return fmin(s->min + s->bin_width * ((double)b + (fraction * total - sum) / count),
                        s->max);
        sum += count;
    }
    return s->max;
}

/* Returns the middle of the values that a bin counts: bins of integer types end a step below
 * the next. */
static double middle_of(const cw_statistics *s, size_t bin)
{
    return s->min + s->bin_width * ((double)bin + 0.5) - s->quantum / 2;
}

/* Returns the fraction of all values that lie between two values. */
static double count_between(const cw_statistics *s, double low, double high)
{
    double sum = 0;
    for (size_t b = 0; b < s->bin_count; b++) {
        const double middle = middle_of(s, b);
        sum += middle >= low && middle <= high ? (double)s->bins[b] : 0;
    }
    return s->finite ? sum / (double)s->finite : 0;
}

/* Returns the value around which most others lie, within 2 % of a range. */
static double find_peak(const cw_statistics *s, double low, double high)
{
    const double reach = fmax((high - low) / 100, s->bin_width);
    double best = -1, peak = low;
    for (size_t b = 0; b < s->bin_count; b++) {
        const double middle = middle_of(s, b);
        const double here = s->bins[b] ? count_between(s, middle - reach, middle + reach) : 0;
        if (here > best) {
            best = here;
            peak = middle;
        }
    }
    return peak;
}

/* Values that separate the surroundings, the objects, and the densest of these: rising, apart,
 * within the range. high: nearly all values are below it. */
typedef struct classes {
    double first, second, high;
} classes;

static size_t bin_of(const cw_statistics *s, double value)
{
    const double b = floor((value - s->min) / s->bin_width);
    return b <= 0 ? 0 : b >= (double)s->bin_count ? s->bin_count - 1 : (size_t)b;
}

/* Returns true if most values lie in the middle, and few above. Then these are surroundings
 * too, such as the noise of a scan, or the material that fills it. */
static bool is_around(const cw_statistics *s, double first, double second)
{
    return count_between(s, first, second) > 0.6 && count_between(s, second, s->max) < 0.15;
}

static classes find_classes(const cw_statistics *s)
{
    classes c;
    double levels[2];
    const double range = s->max - s->min;
    if (!cw_statistics_otsu(s, 2, levels)) {
        levels[0] = s->min + 0.4 * range;
        if (cw_statistics_otsu(s, 1, levels))
            levels[0] = fmax(levels[0], s->min + 0.02 * range);
        levels[1] = levels[0] + 0.5 * (s->max - levels[0]);
    }
    c.first = levels[0];
    c.second = levels[1];
    if (is_around(s, c.first, c.second)) {
        c.first = c.second;
        c.second = (c.first + s->max) / 2;
    }
    c.high = find_quantile(s, bin_of(s, c.first), 0.995);
    c.second = fmin(c.second, c.first + 0.9 * (c.high - c.first));
    if (!(c.high > c.first && c.second > c.first)) {
        c.high = s->max;
        c.second = (c.first + c.high) / 2;
    }
    return c;
}

/* Returns the opacity of a voxel so that a fraction of the volume's width has the given
 * opacity. */
static double spread_opacity(const cw_statistics *s, double opacity, double fraction)
{
    const double across = fmax(cbrt((double)s->finite) * fraction, 1);
    return -expm1(log1p(-opacity) / across);
}

static void make_ct_bone(const cw_statistics *s, cw_transfer *t)
{
    (void)s;
    t->unit_mm = 1;
    put_color(t, 150, 0xa8694a);
    put_color(t, 300, 0xd8b48a);
    put_color(t, 600, 0xf2e6cc);
    put_color(t, 1500, 0xffffff);
    put_opacity(t, 150, 0);
    put_opacity(t, 300, 0.15);
    put_opacity(t, 600, 0.6);
    put_opacity(t, 1500, 0.9);
}

static void make_ct_soft(const cw_statistics *s, cw_transfer *t)
{
    (void)s;
    t->unit_mm = 1;
    put_color(t, -150, 0xd9a066);
    put_color(t, -20, 0xc77e5a);
    put_color(t, 60, 0xa63a35);
    put_color(t, 180, 0xd08a6a);
    put_color(t, 400, 0xf5ecd8);
    put_opacity(t, -150, 0);
    put_opacity(t, -60, 0.015);
    put_opacity(t, 0, 0.03);
    put_opacity(t, 80, 0.12);
    put_opacity(t, 250, 0.3);
    put_opacity(t, 500, 0.7);
}

static void make_ct_skin(const cw_statistics *s, cw_transfer *t)
{
    (void)s;
    t->unit_mm = 1;
    put_color(t, -500, 0xb9775a);
    put_color(t, -100, 0xe5b593);
    put_color(t, 300, 0xf5e6d3);
    put_opacity(t, -600, 0);
    put_opacity(t, -250, 0.4);
    put_opacity(t, 0, 0.7);
}

/* Presets of materials. In Hounsfield units air, fat, soft tissue and bone have their own
 * ranges [Drebin1988]; between them are mixtures. */
static void make_ct_materials(const cw_statistics *s, cw_transfer *t)
{
    static const cw_material_class materials[] = {
        {{-INFINITY, -INFINITY, -900, -150}, {0, 0, 0}, 0, 0},
        {{-900, -150, -90, 20}, {0.94f, 0.78f, 0.50f}, 0.03f, 2},
        {{-90, 20, 80, 600}, {0.80f, 0.36f, 0.30f}, 0.08f, 2.5f},
        {{80, 600, INFINITY, INFINITY}, {0.98f, 0.95f, 0.87f}, 0.8f, 6}};
    cw_error ignored;
    (void)s;
    t->unit_mm = 1;
    if (cw_transfer_set_materials(t, materials, sizeof materials / sizeof *materials,
                                  &ignored) != CW_OK)
        *t = (cw_transfer){0};
}

/* Makes classes of surroundings, things, and dense things, of given colours: surroundings are
 * clear. The inside of materials keeps `inside` of its extinction. */
static void make_classes(const cw_statistics *s, const float colors[2][3],
                         const double opacities[2], double inside, cw_transfer *t)
{
    const classes c = find_classes(s);
    const double low = s->min + 0.5 * (c.first - s->min), fade = 0.5 * (c.first + c.second);
    const double dense = c.second + 0.5 * (c.high - c.second);
    const cw_material_class materials[] = {{{-INFINITY, -INFINITY, low, fade}, {0}, 0, 0},
                                           {{low, fade, c.second, dense},
                                            {colors[0][0], colors[0][1], colors[0][2]},
                                            (float)spread_opacity(s, opacities[0], 0.1),
                                            2},
                                           {{c.second, dense, INFINITY, INFINITY},
                                            {colors[1][0], colors[1][1], colors[1][2]},
                                            (float)spread_opacity(s, opacities[1], 0.05),
                                            4}};
    cw_error ignored;
    if (cw_transfer_set_materials(t, materials, 3, &ignored) != CW_OK)
        *t = (cw_transfer){0};
    t->gradients[t->gradient_count++] = (cw_opacity_point){0, (float)inside};
    t->gradients[t->gradient_count++] = (cw_opacity_point){1, 1};
}

static void make_mr_materials(const cw_statistics *s, cw_transfer *t)
{
    static const float colors[2][3] = {{0.78f, 0.52f, 0.42f}, {0.99f, 0.95f, 0.85f}};
    make_classes(s, colors, (double[2]){0.8, 0.97}, 0.3, t);
}

static void make_metals(const cw_statistics *s, cw_transfer *t)
{
    static const float colors[2][3] = {{0.45f, 0.60f, 0.80f}, {0.95f, 0.75f, 0.25f}};
    make_classes(s, colors, (double[2]){0.9, 0.999}, 0.15, t);
}

/* Makes a preset with tissue as a veil, and brighter parts of it dense. */
static void make_mr(const cw_statistics *s, cw_transfer *t)
{
    const classes c = find_classes(s);
    const double middle = (c.first + c.second) / 2;
    put_color(t, c.first, 0x5a2d23);
    put_color(t, middle, 0xb06f55);
    put_color(t, c.second, 0xdcb896);
    put_color(t, c.high, 0xfff8ea);
    put_opacity(t, c.first, 0);
    put_opacity(t, middle, spread_opacity(s, 0.6, 0.1));
    put_opacity(t, c.second, spread_opacity(s, 0.95, 0.1));
    put_opacity(t, c.high, spread_opacity(s, 0.99, 0.05));
}

static void make_grey_between(double low, double high, cw_transfer *t)
{
    put_color(t, low, 0x000000);
    put_color(t, high, 0xffffff);
}

/* Makes a preset for vessels: black at most values, white at the very highest. Rays show the
 * highest values alone, so that a lower white would saturate bone. */
static void make_mip(const cw_statistics *s, cw_transfer *t)
{
    make_grey_between(find_quantile(s, 0, 0.5), find_quantile(s, 0, 0.99999), t);
    put_opacity(t, t->colors[0].value, 1);
}

static void make_grey(const cw_statistics *s, cw_transfer *t)
{
    make_grey_between(s->min, s->max, t);
    put_opacity(t, s->min, 1);
}

/* Returns true if values look like Hounsfield units: some are air's, near -1000, and some are
 * denser than soft tissue. */
static bool is_hounsfield(const cw_statistics *s)
{
    return s->min >= -8192 && s->max >= 200 && s->max <= 65536 &&
           count_between(s, -1100, -900) > 0.02;
}

/* Makes a preset for slices: greys that the rarest values do not stretch. In Hounsfield units it
 * is the window of soft tissue, 400 wide around 40. */
static void make_window(const cw_statistics *s, cw_transfer *t)
{
    double low = find_quantile(s, 0, 0.005), high = find_quantile(s, 0, 0.995);
    if (is_hounsfield(s))
        low = -160, high = 240;
    if (!(high > low))
        low = s->min, high = s->max;
    make_grey_between(low, high, t);
    put_opacity(t, low, 1);
}

/* Makes a preset for means along rays, which include air and so stay below the densest
 * class. */
static void make_xray(const cw_statistics *s, cw_transfer *t)
{
    make_grey_between(s->min, fmax(find_classes(s).second, s->min + s->bin_width), t);
    put_opacity(t, s->min, 1);
}

static void make_fog(const cw_statistics *s, cw_transfer *t)
{
    const classes c = find_classes(s);
    put_color(t, c.first, 0xb8c8dc);
    put_color(t, c.high, 0xffffff);
    put_opacity(t, c.first, 0);
    put_opacity(t, c.second, spread_opacity(s, 0.5, 0.4));
    put_opacity(t, c.high, spread_opacity(s, 0.9, 0.3));
}

/* Makes a preset for distances from a surface at 0, negative inside: solid, but for half a
 * bin. */
static void make_level_set(const cw_statistics *s, cw_transfer *t)
{
    const double depth = fmin(s->min, 0), soft = 0.05 * fmax(-depth, 1e-30);
    put_color(t, depth, 0xe8ddc8);
    put_opacity(t, -soft, 0.9);
    put_opacity(t, 0, 0);
}

/* Returns true for signed quantities, mostly around 0: both sides get their own colour. */
static bool is_signed(const cw_statistics *s, double low, double high)
{
    const double range = high - low;
    return low < 0 && high > 0 && fmin(-low, high) > 0.2 * range &&
           count_between(s, -0.05 * range, 0.05 * range) > 0.2 &&
           count_between(s, s->min, low + 0.15 * range) < 0.05 &&
           fabs(find_peak(s, low, high)) < 0.03 * range;
}

static void make_signed(const cw_statistics *s, double low, double high, cw_transfer *t)
{
    const double dense = spread_opacity(s, 0.98, 0.1), thin = spread_opacity(s, 0.4, 0.15);
    put_color(t, low, 0x9fd8ff);
    put_color(t, low / 4, 0x2866d8);
    put_color(t, high / 4, 0xd8502a);
    put_color(t, high, 0xffe08a);
    put_opacity(t, low, dense);
    put_opacity(t, low / 3, thin);
    put_opacity(t, low / 8, 0);
    put_opacity(t, high / 8, 0);
    put_opacity(t, high / 3, thin);
    put_opacity(t, high, dense);
}

/* Returns true if air has the highest value of all: a slide scanned by light, an inverted
 * map. */
static bool is_inverted(const cw_statistics *s)
{
    const double range = s->max - s->min;
    return count_between(s, s->max - 0.02 * range, s->max) > 0.5;
}

static void make_inverted(const cw_statistics *s, cw_transfer *t)
{
    const double low = find_quantile(s, 0, 0.005), range = s->max - low;
    put_color(t, low, 0xfff4dc);
    put_color(t, low + 0.5 * range, 0xd9a877);
    put_color(t, low + 0.9 * range, 0x7a3f2c);
    put_opacity(t, low, spread_opacity(s, 0.99, 0.05));
    put_opacity(t, low + 0.6 * range, spread_opacity(s, 0.9, 0.1));
    put_opacity(t, low + 0.93 * range, 0);
}

/* Makes a preset that hides the surroundings of things. The rest fades in; the densest part is
 * nearly solid. */
static void make_above(const cw_statistics *s, cw_transfer *t)
{
    const classes c = find_classes(s);
    const double fade = 0.35 * (c.second - c.first);
    put_color(t, c.first, 0x6b3a2e);
    put_color(t, c.first + fade, 0xb9775a);
    put_color(t, c.second, 0xe3bd92);
    put_color(t, c.high, 0xfff6e4);
    put_opacity(t, c.first, 0);
    put_opacity(t, c.first + fade, spread_opacity(s, 0.8, 0.1));
    put_opacity(t, c.second, spread_opacity(s, 0.95, 0.1));
    put_opacity(t, c.high, spread_opacity(s, 0.999, 0.04));
}

/* Replaces the colours by those of a map, over a range. */
static void put_map(cw_transfer *t, cw_colormap name, double low, double high)
{
    const cwi_colormap *map = cwi_colormap_of(name);
    t->color_count = 0;
    for (size_t n = 0; n < map->count; n++)
        put_color(t, low + (high - low) * (double)n / (double)(map->count - 1), map->colors[n]);
}

/* Makes a preset for fields, with the opacities of auto and the colours of a map. Of a signed
 * quantity the map's middle is at 0. */
static void make_field(const cw_statistics *s, cw_colormap map, cw_transfer *t)
{
    double low = find_quantile(s, 0, 0.0005), high = find_quantile(s, 0, 0.9995);
    const double reach = fmax(-low, high);
    if (is_signed(s, low, high)) {
        make_signed(s, low, high, t);
        low = -reach, high = reach;
    } else {
        make_above(s, t);
    }
    put_map(t, map, low, high > low ? high : s->max);
}

static void make_viridis(const cw_statistics *s, cw_transfer *t)
{
    make_field(s, CW_COLORMAP_VIRIDIS, t);
}

static void make_inferno(const cw_statistics *s, cw_transfer *t)
{
    make_field(s, CW_COLORMAP_INFERNO, t);
}

static void make_cool_warm(const cw_statistics *s, cw_transfer *t)
{
    make_field(s, CW_COLORMAP_COOL_WARM, t);
}

static void make_auto(const cw_statistics *s, cw_transfer *t)
{
    const double low = find_quantile(s, 0, 0.0005), high = find_quantile(s, 0, 0.9995);
    if (is_hounsfield(s))
        make_ct_soft(s, t);
    else if (is_signed(s, low, high))
        make_signed(s, low, high, t);
    else if (is_inverted(s))
        make_inverted(s, t);
    else
        make_above(s, t);
}

static const struct {
    const char *name, *about;
    bool fitted; /* to the values; else at Hounsfield units */
    void (*make)(const cw_statistics *s, cw_transfer *t);
} presets[] = {
    {"auto", "what is around things is left out, the rest fades in; CT as ct-soft", true,
     make_auto},
    {"ct-bone", "bone, in Hounsfield units", false, make_ct_bone},
    {"ct-soft", "soft tissue over bone, in Hounsfield units", false, make_ct_soft},
    {"ct-skin", "skin, in Hounsfield units", false, make_ct_skin},
    {"ct-materials", "air, fat, soft tissue and bone, in Hounsfield units", false,
     make_ct_materials},
    {"mr", "tissue as a veil, what is bright in it dense", true, make_mr},
    {"mr-materials", "tissue and bright tissue, as materials with surfaces", true,
     make_mr_materials},
    {"metals", "a light and a dense material, for industrial CT", true, make_metals},
    {"mip", "opaque greys from the median up, for vessels in mip", true, make_mip},
    {"grey", "opaque greys over the whole range", true, make_grey},
    {"window", "opaque greys for slices: percentiles, or soft tissue of CT", true, make_window},
    {"viridis", "as auto, from violet over green to yellow, for fields", true, make_viridis},
    {"inferno", "as auto, from black over red to yellow, for fields", true, make_inferno},
    {"cool-warm", "as auto, from blue over grey to red, for fields", true, make_cool_warm},
    {"xray", "opaque greys up to the densest class, for average and minip", true, make_xray},
    {"fog", "a thin white haze", true, make_fog},
    {"level-set", "solid below 0", true, make_level_set},
};

enum { PRESETS = sizeof presets / sizeof *presets };

const char *cw_transfer_preset_name(size_t n)
{
    return n < PRESETS ? presets[n].name : NULL;
}

const char *cw_transfer_preset_about(size_t n)
{
    return n < PRESETS ? presets[n].about : NULL;
}

static cw_status fail_unknown(const char *name, cw_error *err)
{
    char list[512] = "";
    size_t used = 0;
    for (size_t n = 0; n < PRESETS; n++)
        used += (size_t)snprintf(list + used, sizeof list - used, " %s", presets[n].name);
    return cwi_fail(err, CW_ERR_ARGUMENT, "no transfer function is named '%.60s'; there are%s",
                    name, list);
}

/* Makes an opaque grey for one value, or none, as there is nothing to distinguish. */
static void make_single(const cw_statistics *s, cw_transfer *t)
{
    put_color(t, s->min, 0xb8b8b8);
    put_opacity(t, s->min, s->finite ? 0.5 : 0);
}

cw_status cw_transfer_preset(const char *name, const cw_statistics *statistics,
                             cw_transfer *transfer, cw_error *err)
{
    CWI_REQUIRE(err, name, transfer);
    size_t n = 0;
    cw_transfer t = {0};
    while (n < PRESETS && strcmp(presets[n].name, name) != 0)
        n++;
    if (n == PRESETS)
        return fail_unknown(name, err);
    if (presets[n].fitted && !statistics)
        return cwi_fail(err, CW_ERR_ARGUMENT, "'%s' is fitted to a volume's values", name);
    if (presets[n].fitted && !(statistics->max > statistics->min && statistics->bin_count))
        make_single(statistics, &t);
    else
        presets[n].make(statistics, &t);
    cw_status st = cw_transfer_check(&t, err);
    if (st == CW_OK)
        *transfer = t;
    return st;
}
