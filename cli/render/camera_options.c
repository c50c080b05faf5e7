/* Checks and makes the cameras of pictures: a named view, angles, a file, or the turns of a
 * turntable. */
#include "cli/render/camera_options.h"

#include "cli/inputs/scene_source.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "core/geometry/vec3.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { FOV = 30 };

static bool is_file(const char *text)
{
    const size_t n = strlen(text);
    return n > 5 && strcmp(text + n - 5, ".json") == 0;
}

static bool is_json(const char *text)
{
    return *text == '{';
}

static bool is_words(const char *text)
{
    return strncmp(text, "eye ", 4) == 0;
}

static bool take_word(const char **text, const char *word)
{
    const size_t length = strlen(word);
    *text += strspn(*text, " ");
    if (strncmp(*text, word, length) != 0)
        return false;
    *text += length;
    return true;
}

static bool take_vector(const char **text, const char *word, double v[3])
{
    return take_word(text, word) && cwi_parse_double(text, &v[0]) && *(*text)++ == ',' &&
           cwi_parse_double(text, &v[1]) && *(*text)++ == ',' && cwi_parse_double(text, &v[2]);
}

static bool take_number(const char **text, const char *word, double *number)
{
    return take_word(text, word) && cwi_parse_double(text, number) && *number > 0;
}

/* "eye 1,2,3 to 4,5,6 up 0,0,1 fov 30": up may be left out; height is of parallel projection. */
static cw_status parse_words(const char *text, cw_camera *camera, cw_error *err)
{
    cw_camera c = {.up = {0, 0, 1}};
    double axes[3][3];
    bool is_good = take_vector(&text, "eye ", c.eye) && take_vector(&text, "to ", c.target) &&
                   (!strstr(text, " up ") || take_vector(&text, "up ", c.up));
    is_good = is_good && (strstr(text, " fov ") ? take_number(&text, "fov ", &c.fov_deg)
                                                : take_number(&text, "height ", &c.height_mm));
    if (!is_good || text[strspn(text, " ")])
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "a camera such as 'eye 1,2,3 to 4,5,6 up 0,0,1 fov 30' (or height MM) "
                        "was expected");
    cw_status st = cw_camera_axes(&c, axes[0], axes[1], axes[2], err);
    if (st == CW_OK)
        *camera = c;
    return st;
}

/* To seven digits. Numbers far below the largest are 0. */
static void round_numbers(double *numbers, size_t count)
{
    double largest = 0;
    for (size_t n = 0; n < count; n++)
        largest = fmax(largest, fabs(numbers[n]));
    for (size_t n = 0; n < count; n++) {
        char text[32];
        const char *at = text;
        snprintf(text, sizeof text, "%.7g", fabs(numbers[n]) < 1e-9 * largest ? 0 : numbers[n]);
        (void)!cwi_parse_double(&at, &numbers[n]);
    }
}

void cli_round_camera(cw_camera *camera)
{
    double coordinates[6];
    memcpy(coordinates, camera->eye, sizeof camera->eye);
    memcpy(coordinates + 3, camera->target, sizeof camera->target);
    round_numbers(coordinates, 6);
    memcpy(camera->eye, coordinates, sizeof camera->eye);
    memcpy(camera->target, coordinates + 3, sizeof camera->target);
    round_numbers(camera->up, 3);
    round_numbers(&camera->fov_deg, 1);
    round_numbers(&camera->height_mm, 1);
}

/* As few digits as give the number again. */
static void print_number(FILE *out, double number)
{
    char text[32];
    for (int digits = 6; digits <= 17; digits++) {
        const char *at = text;
        double again;
        snprintf(text, sizeof text, "%.*g", digits, number);
        if (cwi_parse_double(&at, &again) && again == number)
            break;
    }
    fputs(text, out);
}

static void print_vector(FILE *out, const char *word, const double v[3])
{
    fputs(word, out);
    for (int a = 0; a < 3; a++) {
        fputc(a ? ',' : ' ', out);
        print_number(out, v[a]);
    }
}

char *cli_write_camera(const cw_camera *c)
{
    const bool is_level = c->up[0] == 0 && c->up[1] == 0 && c->up[2] > 0;
    char *text;
    size_t size;
    FILE *out = cwi_text_open(&text, &size);
    if (!out)
        return NULL;
    print_vector(out, "eye", c->eye);
    print_vector(out, " to", c->target);
    if (!is_level)
        print_vector(out, " up", c->up);
    fputs(c->fov_deg > 0 ? " fov " : " height ", out);
    print_number(out, c->fov_deg > 0 ? c->fov_deg : c->height_mm);
    return cwi_text_close(out, &text) ? text : NULL;
}

cw_status cli_read_camera(const char *text, cw_camera *camera, cw_error *err)
{
    if (!is_json(text) && !is_words(text))
        return cw_camera_read(text, camera, err);
    cw_status st =
        is_words(text) ? parse_words(text, camera, err) : cw_camera_parse(text, camera, err);
    return st == CW_OK ? st : cwi_fail_in(err, st, "--camera");
}

static bool is_whole(const char *text)
{
    return is_json(text) || is_words(text) || is_file(text);
}

/* azimuth,elevation */
static bool parse_angles(const char *text, double *azimuth, double *elevation)
{
    return cwi_parse_double(&text, azimuth) && *text++ == ',' &&
           cwi_parse_double(&text, elevation) && *text == '\0';
}

/* Chooses a view for a box: from the front, but flat things are not seen edge-on. */
static const char *choose_view(const double box[2][3])
{
    static const double FLAT = 0.3; /* of the second smallest size */
    double size[3];
    cwi_sub(box[1], box[0], size);
    if (size[2] < FLAT * fmin(size[0], size[1]))
        return "0,60";
    return size[0] < FLAT * fmin(size[1], size[2]) ? "60,0" : "front";
}

static const char *camera_of(const cli_scene *args, const double box[2][3])
{
    return args->camera ? args->camera : choose_view(box);
}

const char *cli_camera_title(const cli_scene *args, const double box[2][3])
{
    const char *camera = camera_of(args, box);
    return is_json(camera) ? "{...}" : is_words(camera) ? "eye ..." : camera;
}

static cw_status add_visible(const cw_volume *volume, const cw_transfer *transfer, int threads,
                             double box[2][3], cw_error *err)
{
    double low[3], high[3];
    cw_status st = cw_transfer_box(volume, transfer, threads, low, high, err);
    for (int a = 0; a < 3 && st == CW_OK; a++) {
        box[0][a] = fmin(box[0][a], low[a]);
        box[1][a] = fmax(box[1][a], high[a]);
    }
    return st;
}

cw_status cli_find_seen_box(const cw_volume *volume, const cw_mesh *mesh, cw_mode mode,
                            const cw_transfer *transfer, int threads, double box[2][3],
                            bool *found, cw_error *err)
{
    const bool blends =
        mode != CW_MODE_MESH && mode != CW_MODE_SLICES && !cw_mode_is_intensity(mode);
    const bool is_trimmed = volume && blends && cw_mode_draws(CW_MODE_COMPOSITE, volume);
    *found = cli_find_box(is_trimmed ? NULL : volume, mesh, box) || is_trimmed;
    return is_trimmed ? add_visible(volume, transfer, threads, box, err) : CW_OK;
}

static cw_fit_desc describe_camera(const cli_scene *args, const double box[2][3])
{
    const char *camera = camera_of(args, box);
    cw_fit_desc fit = {.view = camera, .fov_deg = FOV, .margin = 0.04};
    if (args->fov.given)
        fit.fov_deg = args->fov.value;
    if (args->ortho)
        fit.fov_deg = 0;
    if (parse_angles(camera, &fit.azimuth_deg, &fit.elevation_deg))
        fit.view = "front";
    return fit;
}

double cli_turn_angle(const cli_turns *turns, size_t n)
{
    const double all = turns->orbit.given ? turns->orbit.value : 360;
    const size_t gaps = fabs(all) >= 360 ? turns->count : turns->count - 1;
    return n ? all * (double)n / (double)gaps : 0;
}

static cw_status check_turns(const cli_turns *turns, cw_error *err)
{
    if (turns->orbit.given && turns->count < 2)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--orbit is for the pictures of --turntable N, 2 or more");
    if (turns->count > 100000)
        return cwi_fail(err, CW_ERR_ARGUMENT, "--turntable %zu: at most 100000 were expected",
                        turns->count);
    return CW_OK;
}

cw_status cli_check_camera(const cli_scene *args, const cli_turns *turns, cw_error *err)
{
    static const double box[2][3] = {{0, 0, 0}, {1, 1, 1}};
    cw_camera camera;
    cw_fit_desc fit = describe_camera(args, box);
    cw_status st = check_turns(turns, err);
    if (st != CW_OK)
        return st;
    if (args->zoom.given && !(isnormal(args->zoom.value) && args->zoom.value > 0))
        return cwi_fail(err, CW_ERR_ARGUMENT, "--zoom %g: above 0 was expected",
                        args->zoom.value);
    if (args->fov.given && !(args->fov.value > 0 && args->fov.value < 180))
        return cwi_fail(err, CW_ERR_ARGUMENT, "--fov %g: 0 to 180 degrees were expected",
                        args->fov.value);
    if (args->camera && is_whole(args->camera) && (args->ortho || args->fov.given))
        return cwi_fail(err, CW_ERR_ARGUMENT, "%s is a complete camera; %s cannot change it",
                        cli_camera_title(args, box), args->ortho ? "--ortho" : "--fov");
    if (args->camera && is_whole(args->camera))
        return is_file(args->camera) ? CW_OK : cli_read_camera(args->camera, &camera, err);
    fit.max[0] = fit.max[1] = fit.max[2] = 1;
    return cw_camera_fit(&fit, &camera, err);
}

/* As far away as the turn that needs most. */
static cw_status fit_all(const cli_turns *turns, const cw_fit_desc *first, size_t n,
                         cw_camera *camera, cw_error *err)
{
    double max[2] = {0}, away[3], far;
    for (size_t m = 0; m <= turns->count; m++) {
        cw_fit_desc fit = *first;
        cw_camera c;
        fit.azimuth_deg += cli_turn_angle(turns, m == turns->count ? n : m);
        cw_status st = cw_camera_fit(&fit, m == turns->count ? camera : &c, err);
        if (st != CW_OK)
            return st;
        if (m == turns->count)
            break;
        cwi_sub(c.eye, c.target, away);
        max[0] = fmax(max[0], hypot(hypot(away[0], away[1]), away[2]));
        max[1] = fmax(max[1], c.height_mm);
    }
    cwi_sub(camera->eye, camera->target, away);
    far = hypot(hypot(away[0], away[1]), away[2]);
    for (int a = 0; a < 3; a++)
        camera->eye[a] = camera->target[a] + away[a] * (max[0] / far);
    camera->height_mm = max[1];
    return CW_OK;
}

cw_status cli_find_camera(const cli_scene *args, const cli_turns *turns, size_t n,
                          const double box[2][3], double aspect, cw_camera *camera,
                          cw_error *err)
{
    cw_fit_desc fit = describe_camera(args, box);
    cw_status st;
    fit.aspect = aspect;
    memcpy(fit.min, box[0], sizeof fit.min);
    memcpy(fit.max, box[1], sizeof fit.max);
    if (args->camera && is_whole(args->camera)) {
        st = cli_read_camera(args->camera, camera, err);
        if (st == CW_OK && n)
            st = cw_camera_turn(camera, camera->up, cli_turn_angle(turns, n), err);
    } else if (turns->count > 1) {
        st = fit_all(turns, &fit, n, camera, err);
    } else {
        st = cw_camera_fit(&fit, camera, err);
    }
    if (st == CW_OK && args->zoom.given)
        st = cw_camera_zoom(camera, args->zoom.value, err);
    return st;
}
