/* Commands that change the transfer function. */
#include "cli/session/verbs.h"

#include "core/base/status.h"
#include "viewer/interact/transfer_edit.h"

#include <math.h>
#include <string.h>

/* Makes the drawn transfer function the curve that is edited. */
static cw_status start_edit(view *v, cw_error *err)
{
    cli_scene *s = &v->state.args.scene;
    cw_status st = view_need_volume(v, err);
    if (st == CW_OK)
        st = view_need_transfer(v, err);
    if (st != CW_OK)
        return st;
    v->state.curve = v->picture.transfer;
    v->state.is_edited = true;
    s->shift = s->opacity = (cli_number){0};
    v->picture.transfer_is_old = true;
    view_touch(v, 1 << VIEW_SPACE);
    return CW_OK;
}

static cw_status need_point(const char *verb, double n, size_t count, cw_error *err)
{
    return n >= 0 && n < (double)count && n == floor(n)
               ? CW_OK
               : cwi_fail(err, CW_ERR_ARGUMENT, "%s %g: there are points 0 to %zu", verb, n,
                          count ? count - 1 : 0);
}

static cw_status run_point(view *v, int count, char **args, cw_error *err)
{
    double n[3];
    cw_status st = view_take("point", args, count, n, err);
    if (st == CW_OK)
        st = view_need_volume(v, err);
    if (st == CW_OK)
        st = view_need_transfer(v, err);
    if (st == CW_OK)
        st = need_point("point", n[0], v->picture.transfer.opacity_count, err);
    if (st == CW_OK)
        st = start_edit(v, err);
    if (st == CW_OK)
        cwi_transfer_move_opacity(&v->state.curve, (size_t)n[0], n[1], n[2]);
    return st;
}

static cw_status run_add_point(view *v, int count, char **args, cw_error *err)
{
    double n[2];
    cw_status st = view_take("add-point", args, count, n, err);
    if (st == CW_OK)
        st = start_edit(v, err);
    if (st == CW_OK &&
        cwi_transfer_insert_opacity(&v->state.curve, n[0], n[1]) == CWI_TRANSFER_NONE)
        st = cwi_fail(err, CW_ERR_LIMIT, "a transfer function has %d points at most",
                      CW_TRANSFER_POINTS);
    return st;
}

static cw_status run_remove_point(view *v, int count, char **args, cw_error *err)
{
    double n;
    cw_status st = view_take("remove-point", args, count, &n, err);
    if (st == CW_OK)
        st = start_edit(v, err);
    if (st == CW_OK)
        st = need_point("remove-point", n, v->state.curve.opacity_count, err);
    if (st == CW_OK)
        cwi_transfer_remove_opacity(&v->state.curve, (size_t)n);
    return st;
}

static cw_status take_color(const char *text, float out[3], cw_error *err)
{
    uint8_t rgba[4];
    if (!cli_parse_color(text, rgba))
        return cwi_fail(err, CW_ERR_ARGUMENT, "'%s': a colour such as #ffeedd was expected",
                        text);
    for (int c = 0; c < 3; c++)
        out[c] = (float)rgba[c] / 255;
    return CW_OK;
}

static cw_status run_color_point(view *v, int count, char **args, cw_error *err)
{
    double n;
    float color[3];
    (void)count;
    cw_status st = view_take("color-point", args, 1, &n, err);
    if (st == CW_OK)
        st = take_color(args[1], color, err);
    if (st == CW_OK)
        st = start_edit(v, err);
    if (st == CW_OK)
        st = need_point("color-point", n, v->state.curve.color_count, err);
    if (st == CW_OK)
        memcpy(v->state.curve.colors[(size_t)n].color, color, sizeof color);
    return st;
}

static cw_status run_move_color(view *v, int count, char **args, cw_error *err)
{
    double n[2];
    cw_status st = view_take("move-color", args, count, n, err);
    if (st == CW_OK)
        st = start_edit(v, err);
    if (st == CW_OK)
        st = need_point("move-color", n[0], v->state.curve.color_count, err);
    if (st == CW_OK)
        cwi_transfer_move_color(&v->state.curve, (size_t)n[0], n[1]);
    return st;
}

static cw_status run_add_color(view *v, int count, char **args, cw_error *err)
{
    double n;
    float color[3];
    (void)count;
    cw_status st = view_take("add-color", args, 1, &n, err);
    if (st == CW_OK)
        st = take_color(args[1], color, err);
    if (st == CW_OK)
        st = start_edit(v, err);
    if (st != CW_OK)
        return st;
    const size_t at = cwi_transfer_insert_color(&v->state.curve, n);
    if (at == CWI_TRANSFER_NONE)
        return cwi_fail(err, CW_ERR_LIMIT, "a transfer function has %d points at most",
                        CW_TRANSFER_POINTS);
    memcpy(v->state.curve.colors[at].color, color, sizeof color);
    return CW_OK;
}

static cw_status run_remove_color(view *v, int count, char **args, cw_error *err)
{
    double n;
    cw_status st = view_take("remove-color", args, count, &n, err);
    if (st == CW_OK)
        st = start_edit(v, err);
    if (st == CW_OK)
        st = need_point("remove-color", n, v->state.curve.color_count, err);
    if (st == CW_OK)
        cwi_transfer_remove_color(&v->state.curve, (size_t)n);
    return st;
}

static const view_verb rows[] = {
    EDIT("point", "N VALUE OPACITY", "Move a point of the opacity curve", 3, 3, run_point),
    EDIT("add-point", "VALUE OPACITY", "Add a point to the opacity curve", 2, 2, run_add_point),
    EDIT("remove-point", "N", "Remove a point of the opacity curve", 1, 1, run_remove_point),
    EDIT("color-point", "N COLOR", "Change the colour of a point", 2, 2, run_color_point),
    EDIT("move-color", "N VALUE", "Move a colour point", 2, 2, run_move_color),
    EDIT("add-color", "VALUE COLOR", "Add a colour point", 2, 2, run_add_color),
    EDIT("remove-color", "N", "Remove a colour point", 1, 1, run_remove_color),
};
const view_verbs view_curve_verbs = {rows, sizeof rows / sizeof *rows};
