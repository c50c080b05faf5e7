/* The part of a page on how a mesh looks beside the surface of its volume. */
#include "cli/looks/looks_facts.h"
#include "cli/report/page.h"
#include "cli/study/mesh_study.h"

#include <math.h>

static void put_psnr(FILE *out, double psnr_db)
{
    if (isfinite(psnr_db))
        fprintf(out, "<td>%.1f</td>", psnr_db);
    else
        fputs("<td>equal</td>", out);
}

static void put_row(FILE *out, const char *name, const cw_look_difference *d)
{
    fprintf(out, "<tr><td class=\"w\">%s</td>", name);
    put_psnr(out, d->psnr_db);
    fprintf(out, "<td>%.2f</td>", d->delta_e);
    put_psnr(out, d->psnr_both_db);
    fprintf(out, "<td>%.2f</td></tr>", d->delta_e_both);
}

static void put_table(FILE *out, const cli_mesh_study *m)
{
    fputs("<div class=\"wide\"><table><thead><tr><th class=\"w\"></th><th>PSNR, dB</th>"
          "<th>CIEDE2000</th><th>inside: PSNR, dB</th><th>CIEDE2000</th></tr></thead><tbody>",
          out);
    put_row(out, m->has_maps ? "with its maps" : "the mesh", &m->looks.all);
    if (m->has_maps)
        put_row(out, "without maps", &m->bare_looks.all);
    put_row(out, "the worst view", &m->looks.view[m->looks.worst]);
    fputs("</tbody></table></div>\n", out);
}

static void put_figure(FILE *out, const cli_png *png, const char *name, const char *alt)
{
    if (!png->bytes)
        return;
    fputs("<figure>", out);
    cli_put_image(out, png, alt);
    fprintf(out, "<figcaption><strong>%s</strong></figcaption></figure>\n", name);
}

void cli_put_looks(FILE *out, const cli_mesh_study *m)
{
    char name[CLI_LOOKS_NAME];
    fprintf(
        out,
        "<h2>Looks</h2>\n<p>The mesh beside the surface of the volume, in %u views of the "
        "same light: PSNR and the mean CIEDE2000 of all pixels that show one of them; inside, "
        "of those that show both. 1 is just visible. The pictures are of the worst view, "
        "%s.</p>\n",
        m->looks.views, cli_looks_view_name(&m->looks.place[m->looks.worst], name));
    put_table(out, m);
    fputs("<div class=\"pictures\">\n", out);
    put_figure(out, &m->drawn_source, "the surface", "The surface of the volume, worst view");
    put_figure(out, &m->drawn, m->has_maps ? "the mesh with its maps" : "the mesh",
               "The mesh, worst view");
    put_figure(out, &m->drawn_bare, "without maps", "The mesh without its maps, worst view");
    fputs("</div>\n", out);
}
