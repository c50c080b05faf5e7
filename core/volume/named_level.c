/* Finds the isovalues that names stand for: by Otsu's method, by the range of the values, or in
 * Hounsfield units. */
#include "core/volume/named_level.h"

#include "core/base/status.h"
#include "core/base/text.h"
#include "core/volume/missing_values.h"

#include <stdio.h>
#include <string.h>

/* Levels between classes of values: which of how many. */
static const struct {
    const char *name;
    int number, count;
} class_levels[] = {{"otsu", 0, 1}, {"dark", 0, 3}, {"medium", 1, 3}, {"bright", 2, 3}};

static const struct {
    const char *name;
    double level;
} tissues[] = {
    {"bone", 226},   /* above soft tissue and most of its contrast agents */
    {"skin", -300},  /* between air, -1000, and fat, -100; nearer to fat, for hair and cloth */
    {"soft", -20},   /* between fat, -90, and muscle, 50 */
    {"lung", -500},  /* between lung, -850, and soft tissue */
    {"metal", 2500}, /* above enamel and dense bone */
};

enum {
    CLASS_LEVELS = sizeof class_levels / sizeof *class_levels,
    TISSUES = sizeof tissues / sizeof *tissues
};

double cwi_round_level(double value)
{
    char text[32];
    const char *begin = text;
    snprintf(text, sizeof text, "%.6g", value);
    cwi_parse_double(&begin, &value);
    return value;
}

bool cwi_hounsfield_level(const char *name, double *level)
{
    for (int n = 0; n < TISSUES; n++)
        if (strcmp(tissues[n].name, name) == 0) {
            *level = tissues[n].level;
            return true;
        }
    return false;
}

/* Returns the share of values from low to high, by bins. */
static double share_between(const cw_statistics *s, double low, double high)
{
    uint64_t count = 0;
    for (size_t b = 0; b < s->bin_count; b++) {
        const double value = s->min + s->bin_width * ((double)b + 0.5);
        count += value >= low && value <= high ? s->bins[b] : 0;
    }
    return s->finite ? (double)count / (double)s->finite : 0;
}

bool cwi_is_hounsfield(const cw_volume *volume, const cw_statistics *values)
{
    return (volume->known & CW_KNOWN_HOUNSFIELD) ||
           (values->min <= -900 && values->max >= 100 &&
            share_between(values, -1100, -800) >= 0.01);
}

/* Parses a share of the range, such as 50%. */
static bool parse_percent(const char *name, double *percent)
{
    return cwi_parse_double(&name, percent) && strcmp(name, "%") == 0 && *percent >= 0 &&
           *percent <= 100;
}

static cw_status find_class_level(const cw_statistics *s, const cw_volume *volume, int n,
                                  double *level, cw_error *err)
{
    double values[3];
    char missing[CWI_MISSING_TEXT];
    if (cw_statistics_otsu(s, class_levels[n].count, values)) {
        *level = cwi_round_level(values[class_levels[n].number]);
        return CW_OK;
    }
    cwi_tell_missing(volume, s, missing);
    return cwi_fail(err, CW_ERR_EMPTY,
                    "isovalue %s: the values are too few to be parted into %d classes%s",
                    class_levels[n].name, class_levels[n].count + 1, missing);
}

cw_status cw_statistics_level(const cw_statistics *statistics, const cw_volume *volume,
                              const char *name, double *level, cw_error *err)
{
    CWI_REQUIRE(err, statistics, volume, name, level);
    const cw_statistics *s = statistics;
    double percent;
    if (!s->finite) {
        char missing[CWI_MISSING_TEXT];
        cwi_tell_missing(volume, s, missing);
        return cwi_fail(err, CW_ERR_EMPTY, "no voxel has a finite value%s", missing);
    }
    for (int n = 0; n < CLASS_LEVELS; n++)
        if (strcmp(class_levels[n].name, name) == 0)
            return find_class_level(s, volume, n, level, err);
    if (parse_percent(name, &percent)) {
        *level = cwi_round_level(s->min + percent / 100 * (s->max - s->min));
        return CW_OK;
    }
    double tissue;
    if (!cwi_hounsfield_level(name, &tissue))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "isovalue %s; a number, otsu, dark, medium, bright, bone, skin, soft, "
                        "lung, metal or a percentage of the range such as 50%% were expected",
                        name);
    if (!cwi_is_hounsfield(volume, s))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "isovalue %s is for a CT in Hounsfield units; these values are %g to "
                        "%g, and %.2g %% of them near -1000, as air is. Give a number: "
                        "'cubewright info' suggests some",
                        name, s->min, s->max, 100 * share_between(s, -1100, -800));
    *level = tissue;
    return CW_OK;
}

cw_status cw_volume_level(const cw_volume *volume, const char *name, int threads, double *level,
                          cw_error *err)
{
    CWI_REQUIRE(err, volume, name, level);
    cw_statistics s = {0};
    cw_status st = cw_volume_statistics(volume, CWI_LEVEL_BINS, threads, &s, err);
    if (st == CW_OK)
        st = cw_statistics_level(&s, volume, name, level, err);
    cw_statistics_free(&s);
    return st;
}
