/* Interprets the axes of NRRD, and places the voxels in the world. */
#include "formats/nrrd/nrrd.h"

#include "core/base/status.h"
#include "core/base/text.h"

#include <math.h>
#include <string.h>

static const struct {
    cwi_nrrd_kind kind;
    const char *names;
} kinds[] = {
    {CWI_NRRD_KIND_UNKNOWN, "???|none|stub|scalar"},
    {CWI_NRRD_KIND_SPACE, "domain|space"},
    {CWI_NRRD_KIND_TIME, "time"},
    {CWI_NRRD_KIND_LIST, "list"},
    {CWI_NRRD_KIND_VALUES, "point|vector|covariant-vector|normal|complex|quaternion"},
    {CWI_NRRD_KIND_VALUES, "2-vector|3-vector|4-vector|3-gradient|3-normal"},
    {CWI_NRRD_KIND_VALUES, "3-color|rgb-color|hsv-color|xyz-color|4-color|rgba-color"},
    {CWI_NRRD_KIND_VALUES, "2d-matrix|2d-masked-matrix|3d-matrix|3d-masked-matrix"},
    {CWI_NRRD_KIND_VALUES, "2d-symmetric-matrix|2d-masked-symmetric-matrix"},
    {CWI_NRRD_KIND_VALUES, "3d-symmetric-matrix|3d-masked-symmetric-matrix"},
};

/* Named worlds; sign turns the first two coordinates to left and posterior. */
static const struct {
    const char *names;
    size_t dimension;
    int sign[2];
    bool anatomical;
} spaces[] = {
    {"left-posterior-superior|lps", 3, {1, 1}, true},
    {"right-anterior-superior|ras", 3, {-1, -1}, true},
    {"left-anterior-superior|las", 3, {1, -1}, true},
    {"left-posterior-superior-time|lpst", 4, {1, 1}, true},
    {"right-anterior-superior-time|rast", 4, {-1, -1}, true},
    {"left-anterior-superior-time|last", 4, {1, -1}, true},
    {"scanner-xyz|3d-right-handed|3d-left-handed", 3, {1, 1}, false},
    {"scanner-xyz-time|3d-right-handed-time|3d-left-handed-time", 4, {1, 1}, false},
};

static const struct {
    const char *names;
    double scale; /* to millimetres, or to seconds */
    bool time;
} units[] = {
    {"mm|millimeter|millimeters|millimetre|millimetres", 1, false},
    {"cm|centimeter|centimeters", 10, false},
    {"m|meter|meters", 1000, false},
    {"um|\xc2\xb5m|\xce\xbcm|micron|microns|micrometer|micrometers", 1e-3, false},
    {"s|sec|second|seconds", 1, true},
    {"ms|msec|millisecond|milliseconds", 1e-3, true},
    {"us|usec|microsecond|microseconds", 1e-6, true},
};

/* --- axes -------------------------------------------------------------------------------- */

static void set_kind(cwi_nrrd_axis *a, const char *word)
{
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++)
        if (cwi_field_find(&kinds[k].names, 1, word, strlen(word)) == 0)
            a->kind = kinds[k].kind;
}

static void set_centre(cwi_nrrd_axis *a, const char *word)
{
    a->is_cell = cwi_field_find((const char *const[]){"cell"}, 1, word, strlen(word)) == 0;
}

static void find_unit(const char *word, double *mm, double *seconds)
{
    for (size_t u = 0; u < sizeof units / sizeof *units; u++)
        if (cwi_field_find(&units[u].names, 1, word, strlen(word)) == 0)
            *(units[u].time ? seconds : mm) = units[u].scale;
}

static void set_unit(cwi_nrrd_axis *a, const char *word)
{
    find_unit(word, &a->mm, &a->seconds);
}

/* Reads one word per axis. */
static cw_status read_words(cwi_nrrd *n, cwi_nrrd_field f, const char *name,
                            void (*set)(cwi_nrrd_axis *, const char *), cw_error *err)
{
    char word[CWI_WORD_BYTES];
    const char *s = n->value[f];
    size_t count = 0;
    if (!s)
        return CW_OK;
    for (; cwi_next_text_word(&s, word); count++)
        if (count < n->dimension)
            set(&n->axis[count], word);
    if (count == n->dimension)
        return CW_OK;
    return cwi_fail(err, CW_ERR_FORMAT, "'%s' lists %zu words; 'dimension' says %zu", name,
                    count, n->dimension);
}

/* Reads one number per axis; missing ones keep their values. */
static cw_status read_numbers(cwi_nrrd *n, cwi_nrrd_field f, const char *name, double *out,
                              cw_error *err)
{
    if (!n->value[f])
        return CW_OK;
    return cwi_field_doubles(name, n->value[f], n->dimension, "dimension", out, err);
}

static cw_status read_axes(cwi_nrrd *n, cw_error *err)
{
    cw_status st = read_words(n, CWI_NRRD_KINDS, "kinds", set_kind, err);
    if (st == CW_OK)
        st = read_words(n, CWI_NRRD_CENTERS, "centers", set_centre, err);
    if (st == CW_OK)
        st = read_words(n, CWI_NRRD_UNITS, "units", set_unit, err);
    if (st == CW_OK)
        st = read_numbers(n, CWI_NRRD_SPACINGS, "spacings", n->spacing, err);
    if (st == CW_OK)
        st = read_numbers(n, CWI_NRRD_AXIS_MINS, "axis mins", n->min, err);
    if (st == CW_OK)
        st = read_numbers(n, CWI_NRRD_AXIS_MAXS, "axis maxs", n->max, err);
    return st;
}

/* --- the world --------------------------------------------------------------------------- */

static cw_status read_space(cwi_nrrd *n, cw_error *err)
{
    const char *name = n->value[CWI_NRRD_SPACE];
    int64_t dimension = 0;
    n->space = -1;
    for (int i = 0; name && i < (int)(sizeof spaces / sizeof *spaces); i++)
        if (cwi_field_find(&spaces[i].names, 1, name, strlen(name)) == 0)
            n->space = i;
    if (name && n->space < 0)
        return cwi_fail(err, CW_ERR_FORMAT, "'space' is '%.40s', which NRRD does not define",
                        name);
    if (name && n->value[CWI_NRRD_SPACE_DIMENSION])
        return cwi_fail(err, CW_ERR_FORMAT, "'space' and 'space dimension' exclude each other");
    cw_status st = CW_OK;
    if (n->value[CWI_NRRD_SPACE_DIMENSION])
        st = cwi_field_integer("space dimension", n->value[CWI_NRRD_SPACE_DIMENSION], 2, 3,
                               &dimension, err);
    n->space_dimension = name ? spaces[n->space].dimension : (size_t)dimension;
    return st;
}

/* Reads "(1,0,0)" with as many numbers as the world has dimensions. */
static cw_status read_vector(const cwi_nrrd *n, const char *name, const char **text,
                             double vector[4], cw_error *err)
{
    const char *s = *text + strspn(*text, " \t");
    for (size_t i = 0; i < n->space_dimension; i++) {
        s += strspn(s, " \t");
        if (*s != (i ? ',' : '('))
            goto fail;
        s++;
        if (!cwi_parse_double(&s, &vector[i]) || !isfinite(vector[i]))
            goto fail;
    }
    s += strspn(s, " \t");
    if (*s == ')') {
        *text = s + 1;
        return CW_OK;
    }
fail:
    return cwi_fail(err, CW_ERR_FORMAT, "'%s' holds '%.60s' where (%zu finite numbers) belong",
                    name, *text, n->space_dimension);
}

static cw_status read_directions(cwi_nrrd *n, cw_error *err)
{
    const char *s = n->value[CWI_NRRD_SPACE_DIRECTIONS];
    size_t count = 0;
    cw_status st = CW_OK;
    for (; s && st == CW_OK && *(s += strspn(s, " \t")); count++) {
        cwi_nrrd_axis unused = {0}, *a = count < n->dimension ? &n->axis[count] : &unused;
        a->has_vector = strncmp(s, "none", 4) != 0;
        if (a->has_vector)
            st = read_vector(n, "space directions", &s, a->vector, err);
        else
            s += 4;
        if (st == CW_OK && a->vector[3] != 0 &&
            (a->vector[0] != 0 || a->vector[1] != 0 || a->vector[2] != 0))
            return cwi_fail(
                err, CW_ERR_FORMAT,
                "vector %zu of 'space directions' runs through space and time at once", count);
    }
    if (st == CW_OK && s && count != n->dimension)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "'space directions' lists %zu vectors; 'dimension' says %zu", count,
                        n->dimension);
    return st;
}

static cw_status read_space_units(cwi_nrrd *n, cw_error *err)
{
    char word[CWI_WORD_BYTES];
    const char *s = n->value[CWI_NRRD_SPACE_UNITS];
    size_t count = 0;
    for (; s && cwi_next_text_word(&s, word); count++)
        if (count < n->space_dimension)
            find_unit(word, &n->world_mm[count], &n->world_seconds);
    if (s && count != n->space_dimension)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "'space units' lists %zu words; the space has %zu axes", count,
                        n->space_dimension);
    return CW_OK;
}

static cw_status read_world(cwi_nrrd *n, cw_error *err)
{
    const char *origin = n->value[CWI_NRRD_SPACE_ORIGIN];
    cw_status st = read_space(n, err);
    if (st == CW_OK && !n->space_dimension && (origin || n->value[CWI_NRRD_SPACE_DIRECTIONS]))
        return cwi_fail(
            err, CW_ERR_FORMAT,
            "'space directions' and 'space origin' need 'space' or 'space dimension'");
    if (st == CW_OK)
        st = read_directions(n, err);
    if (st == CW_OK && origin)
        st = read_vector(n, "space origin", &origin, n->origin, err);
    if (st == CW_OK)
        st = read_space_units(n, err);
    return st;
}

/* --- roles ------------------------------------------------------------------------------- */

static bool any_spacing(const cwi_nrrd *n)
{
    for (size_t a = 0; a < n->dimension; a++)
        if (isfinite(n->spacing[a]))
            return true;
    return false;
}

/* Returns true for an axis of space. Direction decides where the header has any; then the kind;
 * then a spacing, where other axes have one. */
static bool is_spatial(const cwi_nrrd *n, size_t index)
{
    const cwi_nrrd_axis *a = &n->axis[index];
    if (n->value[CWI_NRRD_SPACE_DIRECTIONS])
        return a->has_vector && (a->vector[0] != 0 || a->vector[1] != 0 || a->vector[2] != 0 ||
                                 n->space_dimension < 4);
    if (a->kind != CWI_NRRD_KIND_UNKNOWN)
        return a->kind == CWI_NRRD_KIND_SPACE;
    return !(any_spacing(n) && isnan(n->spacing[index]));
}

/* Returns the role of an axis that is not of space. Lists may hold anything. Those with more
 * entries than a voxel may have values are taken as steps, as are slow axes without a kind. */
static cwi_role other_role(const cwi_nrrd_axis *a, bool is_fastest)
{
    if (a->kind == CWI_NRRD_KIND_VALUES ||
        (a->kind == CWI_NRRD_KIND_LIST && a->size <= CWI_NRRD_MAX_VALUES))
        return CWI_AXIS_COMPONENT;
    if (a->kind == CWI_NRRD_KIND_UNKNOWN && is_fastest && !a->has_vector)
        return CWI_AXIS_COMPONENT;
    return CWI_AXIS_STEP;
}

/* Takes axes of unknown spacing and kind as axes of space, too, as long as there are fewer than three:
 * joined slices have such an axis. The fastest one may hold the values of a voxel instead. */
static void find_spatial(const cwi_nrrd *n, bool spatial[CWI_NRRD_MAX_AXES])
{
    size_t count = 0;
    for (size_t i = 0; i < n->dimension; i++)
        count += spatial[i] = is_spatial(n, i);
    if (n->value[CWI_NRRD_SPACE_DIRECTIONS])
        return;
    for (size_t i = 0; i < n->dimension && count < 3; i++) {
        const cwi_nrrd_axis *a = &n->axis[i];
        if (spatial[i] || a->kind != CWI_NRRD_KIND_UNKNOWN || a->seconds != 0 ||
            (i == 0 && a->size <= CWI_NRRD_MAX_VALUES))
            continue;
        spatial[i] = true;
        count++;
    }
}

static cw_status assign_roles(const cwi_nrrd *n, cwi_axis roles[CWI_NRRD_MAX_AXES],
                              cw_error *err)
{
    unsigned seen = 0;
    int spatial = 0;
    bool of_space[CWI_NRRD_MAX_AXES];
    find_spatial(n, of_space);
    for (size_t i = 0; i < n->dimension; i++) {
        const cwi_nrrd_axis *a = &n->axis[i];
        const bool is_space = of_space[i];
        const bool is_fourth = is_space && spatial == 3 && a->kind == CWI_NRRD_KIND_UNKNOWN &&
                               !n->value[CWI_NRRD_SPACE_DIRECTIONS];
        roles[i].size = a->size;
        if (is_space && spatial == 3 && !is_fourth)
            return cwi_fail(err, CW_ERR_FORMAT, "axis %zu of 'sizes' is a fourth axis of space",
                            i);
        roles[i].role = is_space && !is_fourth ? (cwi_role)(CWI_AXIS_X + spatial++)
                        : is_fourth            ? CWI_AXIS_STEP
                                               : other_role(a, i == 0);
        if (seen & 1u << roles[i].role)
            return cwi_fail(err, CW_ERR_FORMAT,
                            "axis %zu of 'sizes' is a second axis of %s; one is read", i,
                            roles[i].role == CWI_AXIS_STEP ? "time" : "values");
        seen |= 1u << roles[i].role;
    }
    if (spatial == 0 || (spatial == 1 && n->value[CWI_NRRD_SPACE_DIRECTIONS]))
        return cwi_fail(err, CW_ERR_FORMAT,
                        "%d axes of 'sizes' are of space; 2 or 3 are needed", spatial);
    return CW_OK;
}

/* --- the frame --------------------------------------------------------------------------- */

static double axis_spacing(const cwi_nrrd *n, size_t i)
{
    const double size = (double)n->axis[i].size, cells = n->axis[i].is_cell ? size : size - 1;
    if (!isnan(n->spacing[i]))
        return n->spacing[i];
    if (isfinite(n->max[i] - n->min[i]) && cells > 0)
        return (n->max[i] - n->min[i]) / cells;
    return 1;
}

/* Returns the start of an axis from axis mins: the first sample, or half a cell before it. */
static double axis_start(const cwi_nrrd *n, size_t i)
{
    return isnan(n->min[i]) ? 0 : n->min[i] + (n->axis[i].is_cell ? axis_spacing(n, i) / 2 : 0);
}

static void set_column(const cwi_nrrd *n, size_t i, int c, double affine[3][4])
{
    const cwi_nrrd_axis *a = &n->axis[i];
    const double mm = a->mm != 0 ? a->mm : 1;
    for (int r = 0; r < 3 && n->value[CWI_NRRD_SPACE_DIRECTIONS]; r++)
        affine[r][c] = a->vector[r];
    if (n->value[CWI_NRRD_SPACE_DIRECTIONS])
        return;
    affine[c][c] = axis_spacing(n, i) * mm;
    if (!n->value[CWI_NRRD_SPACE_ORIGIN])
        affine[c][3] = axis_start(n, i) * mm;
}

/* Returns true if a column of the affine was given in coordinates of the world. A world without
 * directions does not state how the axes lie in it. */
static bool is_of_world(const cwi_nrrd *n, int column)
{
    return n->value[CWI_NRRD_SPACE_DIRECTIONS] ||
           (column == 3 && n->value[CWI_NRRD_SPACE_ORIGIN]);
}

/* Scales and turns the rows of the world; a unit is known when every axis of space has one. */
static void turn_world(const cwi_nrrd *n, bool axes_have_units, cw_volume *shape)
{
    bool world_has_units = n->space_dimension > 0;
    for (int r = 0; r < 3 && r < (int)n->space_dimension; r++) {
        const int sign = n->space >= 0 && r < 2 ? spaces[n->space].sign[r] : 1;
        const double mm = n->world_mm[r] != 0 ? n->world_mm[r] : 1;
        world_has_units = world_has_units && n->world_mm[r] != 0;
        for (int c = 0; c < 4; c++)
            if (is_of_world(n, c))
                shape->affine[r][c] = sign * mm * shape->affine[r][c] + 0.0; /* no -0 */
    }
    const bool anatomical = n->space >= 0 && spaces[n->space].anatomical;
    const bool directed = n->value[CWI_NRRD_SPACE_DIRECTIONS] != NULL;
    shape->known = (anatomical && directed ? CW_KNOWN_FRAME : 0u) |
                   (anatomical || world_has_units || axes_have_units ? CW_KNOWN_UNIT : 0u) |
                   (n->has_segments ? CW_KNOWN_LABELS : 0u);
    shape->said_unit_mm = n->world_mm[0] != 0 ? n->world_mm[0] : n->axis[0].mm;
    shape->said_ras =
        n->space >= 0 && spaces[n->space].sign[0] < 0 && spaces[n->space].sign[1] < 0;
}

static double step_seconds(const cwi_nrrd *n, size_t i)
{
    const cwi_nrrd_axis *a = &n->axis[i];
    const double seconds = a->has_vector ? fabs(a->vector[3]) * n->world_seconds
                                         : fabs(n->spacing[i]) * a->seconds;
    return isfinite(seconds) ? seconds : 0;
}

static void set_frame(const cwi_nrrd *n, const cwi_axis *roles, cw_volume *shape)
{
    bool axes_have_units = !n->value[CWI_NRRD_SPACE_DIRECTIONS];
    for (int r = 0; r < 3; r++)
        shape->affine[r][3] = n->origin[r];
    for (size_t i = 0; i < n->dimension; i++) {
        if (roles[i].role == CWI_AXIS_STEP)
            shape->step_seconds = step_seconds(n, i);
        if (roles[i].role > CWI_AXIS_Z)
            continue;
        set_column(n, i, (int)roles[i].role, shape->affine);
        axes_have_units = axes_have_units && n->axis[i].mm != 0;
    }
    turn_world(n, axes_have_units, shape);
}

/* Adds missing axes, perpendicular to the existing ones, a millimetre apart. */
static void add_missing_axes(const cwi_axis *roles, size_t count, bool has_directions,
                             double affine[3][4])
{
    bool has[3] = {false, false, false};
    for (size_t i = 0; i < count; i++)
        if (roles[i].role <= CWI_AXIS_Z)
            has[roles[i].role] = true;
    for (int c = 0; c < 3 && !has_directions; c++)
        if (!has[c])
            affine[c][c] = 1;
    if (has_directions && !has[2])
        cwi_fill_columns(affine);
}

/* Tells of axes without a spacing where others have one. */
static void note_spacings(const cwi_nrrd *n, const cwi_axis *roles, cwi_source *src)
{
    if (n->value[CWI_NRRD_SPACE_DIRECTIONS] || !any_spacing(n))
        return;
    for (size_t i = 0; i < n->dimension; i++)
        if (roles[i].role <= CWI_AXIS_Z && isnan(n->spacing[i]) &&
            !isfinite(n->max[i] - n->min[i]))
            cwi_source_note(src, "'spacings' does not state that of axis %zu: 1 is taken", i);
}

cw_status cwi_nrrd_describe(cwi_nrrd *n, cwi_source *src, cw_error *err)
{
    cwi_axis roles[CWI_NRRD_MAX_AXES];
    cw_status st = read_axes(n, err);
    if (st == CW_OK)
        st = read_world(n, err);
    if (st == CW_OK)
        st = assign_roles(n, roles, err);
    if (st == CW_OK)
        st = cwi_source_set_axes(src, roles, n->dimension, err);
    if (st != CW_OK)
        return st;
    set_frame(n, roles, &src->shape);
    note_spacings(n, roles, src);
    add_missing_axes(roles, n->dimension, n->value[CWI_NRRD_SPACE_DIRECTIONS] != NULL,
                     src->shape.affine);
    return CW_OK;
}
