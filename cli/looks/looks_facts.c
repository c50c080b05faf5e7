/* Prints how alike two surfaces look, writes it as JSON, and parses limits of it. */
#include "cli/looks/looks_facts.h"

#include "cli/framework/console.h"
#include "core/base/status.h"
#include "core/base/text.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

cw_status cli_looks_parse(const char *text, cli_looks_limit *limit, cw_error *err)
{
    const char *at = text;
    char separator = 0, item[CWI_ITEM_BYTES];
    *limit = (cli_looks_limit){0};
    if (strcmp(text, "none") == 0)
        return CW_OK;
    do {
        double value;
        const char *end = item;
        if (!cwi_next_item(&at, &separator, item) || !cwi_parse_double(&end, &value) ||
            !(value > 0) || !isfinite(value) || (*end && strcmp(end, "dB") != 0) ||
            separator == 'x')
            return cwi_fail(err, CW_ERR_ARGUMENT,
                            "--looks '%s': expected none, a mean CIEDE2000 above 0 such as 2, "
                            "or a PSNR such as 25dB",
                            text);
        if (*end)
            limit->min_psnr_db = value;
        else
            limit->max_delta_e = value;
    } while (separator);
    return CW_OK;
}

const char *cli_looks_view_name(const cw_appearance_view *view, char name[CLI_LOOKS_NAME])
{
    snprintf(name, CLI_LOOKS_NAME, "az%03.0f_el%+03.0f", view->azimuth_deg,
             view->elevation_deg);
    return name;
}

static const char *psnr_text(double psnr_db, char text[16])
{
    snprintf(text, 16, isfinite(psnr_db) ? "%.2f dB" : "equal", psnr_db);
    return text;
}

cw_status cli_looks_hold(const cli_looks_limit *limit, const cw_appearance *looks,
                         cw_error *err)
{
    const cw_look_difference *all = &looks->all;
    if (limit->max_delta_e > 0 && all->delta_e > limit->max_delta_e)
        return cwi_fail(err, CW_ERR_CHECK, "CIEDE2000 %.3g; --looks allows at most %g",
                        all->delta_e, limit->max_delta_e);
    if (limit->min_psnr_db > 0 && all->psnr_db < limit->min_psnr_db)
        return cwi_fail(err, CW_ERR_CHECK, "PSNR %.4g dB; --looks asks for at least %g dB",
                        all->psnr_db, limit->min_psnr_db);
    return CW_OK;
}

void cli_looks_text(const cw_appearance *with, const cw_appearance *without,
                    char text[CLI_LOOKS_TEXT])
{
    char psnr[16], bare[40] = "";
    if (without)
        snprintf(bare, sizeof bare, " (%.2f without maps)", without->all.delta_e);
    snprintf(text, CLI_LOOKS_TEXT, "PSNR %s, CIEDE2000 %.2f%s",
             psnr_text(with->all.psnr_db, psnr), with->all.delta_e, bare);
}

static void print_line(const char *name, const cw_look_difference *d)
{
    char all[16], both[16];
    cli_result("    %-20s%10s%11.2f%16s%11.2f\n", name, psnr_text(d->psnr_db, all), d->delta_e,
               psnr_text(d->psnr_both_db, both), d->delta_e_both);
}

void cli_looks_print(const cw_appearance *with, const cw_appearance *without)
{
    char name[CLI_LOOKS_NAME], line[40];
    cli_result("  looks, %u views       %10s%11s%16s%11s\n", with->views, "PSNR", "CIEDE2000",
               "inside: PSNR", "CIEDE2000");
    print_line(without ? "with its maps" : "beside the reference", &with->all);
    if (without)
        print_line("without maps", &without->all);
    snprintf(line, sizeof line, "worst: %s",
             cli_looks_view_name(&with->place[with->worst], name));
    print_line(line, &with->view[with->worst]);
}

static void put_difference(cli_json *j, const cw_look_difference *d)
{
    cli_json_count(j, "pixels", d->pixels);
    cli_json_count(j, "shown_by_one", d->shown_by_one);
    cli_json_number(j, "rmse", d->rmse);
    cli_json_number(j, "psnr_db", d->psnr_db);
    cli_json_number(j, "ciede2000", d->delta_e);
    cli_json_number(j, "rmse_inside", d->rmse_both);
    cli_json_number(j, "psnr_inside_db", d->psnr_both_db);
    cli_json_number(j, "ciede2000_inside", d->delta_e_both);
}

static void put_views(cli_json *j, const cw_appearance *looks)
{
    char name[CLI_LOOKS_NAME];
    cli_json_open(j, "views", '[');
    for (uint32_t n = 0; n < looks->views; n++) {
        cli_json_open(j, NULL, '{');
        cli_json_text(j, "name", cli_looks_view_name(&looks->place[n], name));
        cli_json_number(j, "azimuth", looks->place[n].azimuth_deg);
        cli_json_number(j, "elevation", looks->place[n].elevation_deg);
        put_difference(j, &looks->view[n]);
        cli_json_close(j, '}');
    }
    cli_json_close(j, ']');
}

static void put_looks(cli_json *j, const char *key, const cw_appearance *looks)
{
    char name[CLI_LOOKS_NAME];
    cli_json_open(j, key, '{');
    put_difference(j, &looks->all);
    cli_json_text(j, "worst", cli_looks_view_name(&looks->place[looks->worst], name));
    put_views(j, looks);
    cli_json_close(j, '}');
}

void cli_looks_json(cli_json *j, const cw_appearance *with, const cw_appearance *without)
{
    cli_json_open(j, "looks", '{');
    cli_json_count(j, "size", with->size);
    put_looks(j, "all", with);
    if (without)
        put_looks(j, "without_maps", without);
    cli_json_close(j, '}');
}
