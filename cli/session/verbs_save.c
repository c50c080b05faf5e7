/* Commands that undo and that write files. */
#include "cli/session/verbs.h"

#include "cli/framework/name_template.h"
#include "cli/framework/quantity.h"
#include "cli/results/output_names.h"
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static cw_status go_back(view *v, int by, cw_error *err)
{
    const char *none = by < 0 ? "nothing to undo" : "nothing to redo";
    const bool is_done = view_undo(v, by);
    if (!is_done && v->script.is_queued) { /* a key was pressed once too often */
        view_say(v, false, none);
        return CW_OK;
    }
    if (!is_done)
        return cwi_fail(err, CW_ERR_ARGUMENT, "%s", none);
    v->picture.transfer_is_old = true;
    view_touch(v, VIEW_ALL);
    return view_choose_mode(v, err);
}

static cw_status run_undo(view *v, int count, char **args, cw_error *err)
{
    (void)count, (void)args;
    return go_back(v, -1, err);
}

static cw_status run_redo(view *v, int count, char **args, cw_error *err)
{
    (void)count, (void)args;
    return go_back(v, 1, err);
}

/* Finds the first name such as cubewright-001.png that no file has. */
static void free_name(char *name, size_t size)
{
    for (int n = 1; n < 10000; n++) {
        snprintf(name, size, "cubewright-%03d.png", n);
        if (access(name, F_OK) != 0)
            return;
    }
}

static cw_status report_written(view *v, cw_status st, const char *path)
{
    char text[512];
    snprintf(text, sizeof text, "%.400s written", path);
    if (st == CW_OK)
        view_say(v, false, text);
    return st;
}

static cw_status need_png(const char *path, cw_error *err)
{
    const char *dot = strrchr(path, '.');
    return dot && strcmp(dot, ".png") == 0
               ? CW_OK
               : cwi_fail(err, CW_ERR_ARGUMENT, "%s: pictures are written as .png", path);
}

/* Parses a size such as "1920x1080", or a layout. */
static cw_status parse_sheet(const char *word, view_sheet *sheet, cw_error *err)
{
    static const char *const layouts[] = {"shown", "single", "quad"};
    enum { MAX_PIXELS = 16384 };
    const char *text = word;
    double w, h;
    for (int n = 0; n < 3; n++)
        if (strcmp(word, layouts[n]) == 0) {
            sheet->layout = (view_layout)n;
            return CW_OK;
        }
    if (!(cwi_parse_double(&text, &w) && *text++ == 'x' && cwi_parse_double(&text, &h) &&
          *text == '\0' && w >= 1 && h >= 1 && w <= MAX_PIXELS && h <= MAX_PIXELS))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "screenshot '%s': a size such as 1920x1080 (up to %d), single or quad "
                        "was expected",
                        word, MAX_PIXELS);
    sheet->width = (size_t)w;
    sheet->height = (size_t)h;
    return CW_OK;
}

static cw_status run_screenshot(view *v, int count, char **args, cw_error *err)
{
    char name[64];
    view_sheet sheet = {0};
    free_name(name, sizeof name);
    const char *path = count ? args[0] : name;
    cw_status st = need_png(path, err);
    for (int n = 1; n < count && st == CW_OK; n++)
        st = parse_sheet(args[n], &sheet, err);
    if (st == CW_OK)
        st = view_frame(v, 0, err); /* lays out what came before */
    return st == CW_OK ? report_written(v, view_write_picture(v, &sheet, path, err), path) : st;
}

static cw_status parse_triangles(const char *word, size_t *triangles, cw_error *err)
{
    return cli_parse_count(word, 1000, triangles) || strcmp(word, "0") == 0
               ? CW_OK
               : cwi_fail(err, CW_ERR_ARGUMENT,
                          "'%s': a number of triangles such as 50k was expected", word);
}

static cw_status run_measure_mesh(view *v, int count, char **args, cw_error *err)
{
    view_measured_mesh *m = &v->document.measured;
    size_t triangles = 0;
    cw_mesh simplified;
    const cw_mesh *mesh;
    cw_status st = count ? parse_triangles(args[0], &triangles, err) : CW_OK;
    m->is_known = false;
    if (st == CW_OK)
        st = view_make_mesh(v, triangles, &simplified, &mesh, &m->facts, err);
    if (st == CW_OK)
        cw_mesh_free(&simplified);
    m->is_known = st == CW_OK;
    m->triangles = triangles;
    m->iso = v->state.args.iso.value;
    return st;
}

static cw_status run_save_mesh(view *v, int count, char **args, cw_error *err)
{
    const cw_write_desc desc = {0};
    view_mesh_facts facts = {0};
    size_t triangles = 0;
    cw_mesh simplified = {0};
    const cw_mesh *mesh;
    char text[VIEW_MESSAGE];
    struct stat info = {0};
    cw_status st = count > 1 ? parse_triangles(args[1], &triangles, err) : CW_OK;
    if (st == CW_OK)
        st = cw_mesh_write_check(args[0], &desc, err);
    if (st == CW_OK)
        st = cli_check_output(args[0], (const char *const *)v->document.files,
                              v->document.file_count, err);
    if (st == CW_OK)
        st = view_make_mesh(v, triangles, &simplified, &mesh, &facts, err);
    if (st == CW_OK)
        st = cw_mesh_write(args[0], mesh, &desc, err);
    cw_mesh_free(&simplified);
    if (st != CW_OK)
        return st;
    const int used = snprintf(text, sizeof text, "%.400s written, %.3g MB: ", args[0],
                              stat(args[0], &info) == 0 ? (double)info.st_size / 1e6 : 0);
    view_describe_mesh(&facts, text + used, sizeof text - (size_t)used);
    view_say(v, false, text);
    return CW_OK;
}

static cw_status run_capture(view *v, int count, char **args, cw_error *err)
{
    cw_image image = {0};
    const bool now = count > 1;
    cw_status st = need_png(args[0], err);
    if (st == CW_OK && now && strcmp(args[1], "now") != 0)
        st = cwi_fail(err, CW_ERR_ARGUMENT, "capture takes a file and, maybe, 'now', not '%s'",
                      args[1]);
    if (st == CW_OK && !now)
        st = view_settle(v, err);
    for (int n = 0; n < 2 && st == CW_OK && now; n++) /* the second shows what the first drew */
        st = view_frame(v, 0, err);
    if (st == CW_OK)
        st = v->ui->grab(v->window, &image, err);
    if (st == CW_OK)
        st = cw_image_write(args[0], &image, err);
    cw_image_free(&image);
    return st;
}

/* Turns the camera once around, and back to where it began. */
static cw_status run_turntable(view *v, int count, char **args, cw_error *err)
{
    double turns;
    char number[24], *path = NULL;
    (void)count;
    cw_status st = view_take("turntable", args, 1, &turns, err);
    if (st == CW_OK && !(turns >= 2 && turns <= 100000 && turns == floor(turns)))
        st = cwi_fail(err, CW_ERR_ARGUMENT, "turntable %s: 2 to 100000 was expected", args[0]);
    if (st == CW_OK)
        st = need_png(args[1], err);
    if (st == CW_OK)
        st = view_frame(v, 0, err); /* lays out what came before */
    if (st == CW_OK)
        st = view_need_camera(v, err);
    if (st != CW_OK)
        return st;
    const cw_camera before = v->state.camera;
    for (size_t n = 0; n < (size_t)turns && st == CW_OK; n++) {
        snprintf(number, sizeof number, "%zu", n);
        cli_part part = {"turn", number, true, false};
        st = cli_fill_template(args[1], &part, 1, &path, err);
        if (st == CW_OK && !part.used)
            st = cwi_fail(
                err, CW_ERR_ARGUMENT,
                "turntable '%s': the name must hold {turn}, as in 'turn-{turn:03d}.png'",
                args[1]);
        if (st == CW_OK)
            st = view_write_picture(v, &(view_sheet){.layout = VIEW_LAYOUT_SINGLE}, path, err);
        free(path);
        path = NULL;
        if (st == CW_OK)
            st = cw_camera_orbit(&v->state.camera, 360 / turns, 0, err);
    }
    v->state.camera = before;
    view_touch(v, 1 << VIEW_SPACE);
    return report_written(v, st, args[1]);
}

static cw_status run_save_state(view *v, int count, char **args, cw_error *err)
{
    const char *path = count ? args[0] : "cubewright-state.txt";
    return report_written(v, view_write_state(v, path, err), path);
}

static cw_status run_save_tf(view *v, int count, char **args, cw_error *err)
{
    (void)count;
    cw_status st = view_need_volume(v, err);
    if (st == CW_OK)
        st = view_need_transfer(v, err);
    if (st == CW_OK)
        st = cw_transfer_write(args[0], &v->picture.transfer, err);
    return report_written(v, st, args[0]);
}

static cw_status run_save_camera(view *v, int count, char **args, cw_error *err)
{
    (void)count;
    cw_status st = view_need_camera(v, err);
    if (st == CW_OK)
        st = cw_camera_write(args[0], &v->state.camera, err);
    return report_written(v, st, args[0]);
}

static cw_status run_run(view *v, int count, char **args, cw_error *err)
{
    (void)count; /* a file may run others, but not itself for ever */
    if (v->script.depth >= 8)
        return cwi_fail(err, CW_ERR_LIMIT, "run %s: files run each other more than 8 deep",
                        args[0]);
    v->script.depth++;
    cw_status st = view_exec_file(v, args[0], err);
    v->script.depth--;
    return st;
}

static cw_status run_copy_command(view *v, int count, char **args, cw_error *err)
{
    (void)count, (void)args;
    if (v->state
            .is_placed) { /* the line is short, and gives what the window shows from now on */
        cli_round_camera(&v->state.camera);
        view_touch(v, 1 << VIEW_SPACE);
    }
    char *line = view_command_line(v);
    if (!line)
        return cwi_fail_memory(err);
    v->ui->set_clipboard(v->window, line);
    free(line);
    view_say(v, false, "the command line is in the clipboard");
    return CW_OK;
}

static const view_verb rows[] = {
    VERB("undo", "", "Undo the last change", 0, 0, run_undo),
    VERB("redo", "", "Redo the last undone change", 0, 0, run_redo),
    VERB("screenshot", "[FILE] [WxH] [single|quad]",
         "Save the picture as a .png file, by default in the size and layout of the window", 0,
         3, run_screenshot),
    VERB("measure-mesh", "[TRIANGLES]",
         "Measure size, closedness and error of the surface, simplified to TRIANGLES", 0, 1,
         run_measure_mesh),
    VERB("save-mesh", "FILE [TRIANGLES]", "Save the surface as a mesh, simplified to TRIANGLES",
         1, 2, run_save_mesh),
    VERB("capture", "FILE [now]",
         "Save the whole window as a .png file; now: before the picture is refined", 1, 2,
         run_capture),
    VERB("turntable", "N FILE", "Save N pictures around the scene; FILE holds {turn}", 2, 2,
         run_turntable),
    VERB("save-state", "[FILE]", "Save the session as commands", 0, 1, run_save_state),
    VERB("save-tf", "FILE", "Save the transfer function", 1, 1, run_save_tf),
    VERB("save-camera", "FILE", "Save the camera", 1, 1, run_save_camera),
    VERB("run", "FILE", "Run the commands of a file", 1, 1, run_run),
    VERB("copy-command", "", "Copy the session as a command line", 0, 0, run_copy_command),
};
const view_verbs view_save_verbs = {rows, sizeof rows / sizeof *rows};
