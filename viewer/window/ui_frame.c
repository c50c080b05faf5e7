/* Runs a frame from begin to end: takes input, lays out widgets, and shows the result. */
#include "core/base/memory.h"
#include "viewer/window/ui_internal.h"

static cw_status check_desc(const cwi_ui_desc *desc, cw_error *err)
{
    if (desc->width < 1 || desc->width > CWI_UI_LARGEST || desc->height < 1 ||
        desc->height > CWI_UI_LARGEST)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "a window of %zu x %zu pixels; 1 x 1 to %d x %d was expected",
                        desc->width, desc->height, CWI_UI_LARGEST, CWI_UI_LARGEST);
    if (!(desc->scale == 0 || (desc->scale >= 0.25 && desc->scale <= 8)))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "a scale of letters of %g; 0.25 to 8 was expected", desc->scale);
    return CW_OK;
}

static cw_status open_all(cwi_ui *ui, const cwi_ui_desc *desc, cw_error *err)
{
    cw_status st = cwi_ui_screen_open(ui, desc, err);
    if (st != CW_OK)
        return st;
    if (!cwi_ui_screen_enter(ui))
        return cwi_fail(err, CW_ERR_BACKEND, "OpenGL's context cannot be made current");
    st = cwi_ui_imgui_open(ui, err);
    cwi_ui_screen_leave(ui);
    return st;
}

cw_status cwi_ui_open(const cwi_ui_desc *desc, cwi_ui **out, cw_error *err)
{
    cw_status st = check_desc(desc, err);
    if (st != CW_OK)
        return st;
    cwi_ui *ui = cwi_alloc_zeroed(1, sizeof *ui);
    if (!ui)
        return cwi_fail_memory(err);
    ui->input.x = ui->input.y = -1;
    ui->settle = 3;
    st = open_all(ui, desc, err);
    if (st != CW_OK) {
        cwi_ui_close(ui);
        return st;
    }
    *out = ui;
    return CW_OK;
}

void cwi_ui_close(cwi_ui *ui)
{
    if (!ui)
        return;
    if (ui->screen && cwi_ui_screen_enter(ui)) {
        cwi_ui_imgui_close(ui);
        cwi_ui_target_free(ui);
        cwi_ui_screen_leave(ui);
    }
    cwi_ui_screen_close(ui);
    cwi_ui_queue_free(ui);
    cwi_free(ui->now.items);
    cwi_free(ui->last.items);
    cwi_free(ui);
}

bool cwi_ui_pending(cwi_ui *ui)
{
    size_t size[2];
    cwi_ui_screen_wait(ui, 0);
    cwi_ui_screen_size(ui, size);
    return ui->queue.first < ui->queue.count || size[0] != ui->input.width ||
           size[1] != ui->input.height;
}

/* Returns the time to wait: none while input waits, or while layouts follow the last input. */
static double time_to_wait(const cwi_ui *ui, double wait_s)
{
    if (ui->queue.first < ui->queue.count || ui->settle > 0 || !(wait_s > 0))
        return 0;
    return ui->wake > 0 && ui->wake < wait_s ? ui->wake : wait_s;
}

/* Waits for input. After a wake-up by the clock, such as for a tooltip, one more frame is
 * needed to lay out. */
static void wait_for_input(cwi_ui *ui, double wait_s)
{
    const double seconds = time_to_wait(ui, wait_s);
    const bool by_clock = seconds > 0 && seconds == ui->wake;
    cwi_ui_screen_wait(ui, seconds);
    ui->settle = by_clock ? 2 : ui->settle - (ui->settle > 0);
    ui->wake = 0;
}

static void take_size(cwi_ui *ui)
{
    size_t size[2];
    cwi_ui_screen_size(ui, size);
    if (size[0] != ui->input.width || size[1] != ui->input.height)
        ui->settle = 3;
    ui->input.width = size[0];
    ui->input.height = size[1];
}

const cwi_ui_input *cwi_ui_begin(cwi_ui *ui, double wait_s)
{
    cwi_ui_imgui_choose(ui);
    wait_for_input(ui, wait_s);
    cwi_ui_queue_take(ui);
    take_size(ui);
    ui->before = ui->time;
    ui->time = cwi_ui_screen_frame_time(ui);
    cwi_ui_imgui_begin(ui);
    return &ui->input;
}

cw_status cwi_ui_end(cwi_ui *ui, cw_error *err)
{
    cwi_ui_imgui_layout(ui);
    cwi_ui_widget_rects_turn(ui);
    if (!cwi_ui_screen_enter(ui))
        return cwi_fail(err, CW_ERR_BACKEND, "OpenGL's context cannot be made current");
    cwi_ui_target_begin(ui);
    cwi_ui_imgui_draw();
    cwi_ui_screen_show(ui);
    const cw_status st = cwi_ui_target_check(err);
    cwi_ui_screen_leave(ui);
    cwi_ui_screen_cursor(ui, cwi_ui_imgui_cursor(ui));
    return st;
}

cw_status cwi_ui_grab(cwi_ui *ui, cw_image *image, cw_error *err)
{
    if (!cwi_ui_screen_enter(ui))
        return cwi_fail(err, CW_ERR_BACKEND, "OpenGL's context cannot be made current");
    const cw_status st = cwi_ui_target_grab(ui, image, err);
    cwi_ui_screen_leave(ui);
    return st;
}

cw_status cwi_ui_keep(cwi_ui *ui, int slot, const cw_image *image, cw_error *err)
{
    if (slot < 0 || slot >= CWI_UI_SLOTS)
        return cwi_fail(err, CW_ERR_ARGUMENT, "no slot for pictures is number %d; 0 to %d are",
                        slot, CWI_UI_SLOTS - 1);
    if (!cwi_ui_screen_enter(ui))
        return cwi_fail(err, CW_ERR_BACKEND, "OpenGL's context cannot be made current");
    const cw_status st = cwi_ui_target_keep(ui, slot, image, err);
    cwi_ui_screen_leave(ui);
    return st;
}

const char *cwi_ui_name(const cwi_ui *ui)
{
    return ui->name;
}

double cwi_ui_scale(const cwi_ui *ui)
{
    return ui->scale;
}

void cwi_ui_set_cursor(cwi_ui *ui, int shape)
{
    ui->cursor = shape;
}
