/* The page of one mesh and its source. */
#include "cli/framework/quantity.h"
#include "cli/report/page.h"
#include "cli/study/mesh_study.h"

#include <stdlib.h>

/* Distances, in voxels, of 99 % of a mesh: as extraction leaves it, as light simplification or
 * smoothing does, and of another surface. */
static const double AS_EXTRACTED = 0.1, AS_SIMPLIFIED = 1;

static const char *judge_distance(const cli_mesh_study *m)
{
    const double voxels = m->to_field.p99_mm / m->study.voxel_mm,
                 back = m->from_field.p99_mm / m->study.voxel_mm;
    if (voxels > AS_SIMPLIFIED)
        return "It is another surface: of another level, another volume or another place, or it "
               "was changed by more than a voxel.";
    if (back > AS_SIMPLIFIED)
        return "It is on the surface, but a part of the surface has no mesh.";
    return voxels > AS_EXTRACTED || back > AS_EXTRACTED
               ? "It is this surface, changed by less than a voxel, as by simplification or "
                 "smoothing."
               : "It is this surface, as extraction makes it.";
}

static void put_intro(FILE *out, const cli_mesh_study *m)
{
    fputs("<h1>", out);
    cli_put_html(out, m->study.title);
    fprintf(out, "</h1>\n<p>A mesh of %s triangles, held against the surface of ",
            cli_count(m->study.full.triangle_count));
    cli_put_html(out, cli_shown_path(m->study.volume->path));
    fprintf(
        out,
        " at the level %s. 99 %% of the mesh are within %.3g mm (%.3g voxels) of the "
        "surface, 99 %% of the surface within %.3g mm of the mesh. <strong>%s</strong></p>\n",
        cli_number_text(m->study.iso), m->to_field.p99_mm,
        m->to_field.p99_mm / m->study.voxel_mm, m->from_field.p99_mm, judge_distance(m));
    if (m->is_open)
        fputs(
            "<p>The mesh is open, so the surface is taken as open where the volume ends, too.</p>\n",
            out);
    if (!m->is_fitted)
        return;
    fprintf(
        out,
        "<p>No level was stated. This one is the median of the field at %s vertices, half "
        "of which have values from %.6g to %.6g: the narrower that is, the surer is the level.",
        cli_count(m->fit_count - m->fit_outside), m->fit_low, m->fit_high);
    if (m->is_unsure)
        fputs(
            " They differ by more than rounding: <strong>the mesh was made from filtered voxels, "
            "smoothed or simplified.</strong> The same filters (--denoise, --resample) find its "
            "level; --iso states it.",
            out);
    if (m->fit_outside)
        fprintf(out, " Another %s are outside of the volume.", cli_count(m->fit_outside));
    fputs("</p>\n", out);
}

static void put_mesh_facts(FILE *out, const cli_mesh_study *m)
{
    const cw_quality *q = &m->quality;
    const bool closed = cw_quality_is_closed_manifold(q);
    char text[160];
    fputs("<dl class=\"facts\">", out);
    snprintf(text, sizeof text, "%s, %s", m->mesh.file.format,
             cli_bytes((double)m->file_bytes));
    cli_put_fact(out, "file", text);
    snprintf(text, sizeof text, "%s triangles", cli_count(q->triangles));
    cli_put_fact(out, "mesh", text);
    snprintf(text, sizeof text, "%s%s", closed ? "yes" : "no",
             q->open_edges ? ", open edges" : "");
    cli_put_fact(out, "closed manifold", text);
    snprintf(text, sizeof text, "%s", cli_count(q->components));
    cli_put_fact(out, "components", text);
    snprintf(text, sizeof text, "%.4g \xc3\x97 %.4g \xc3\x97 %.4g mm", q->max[0] - q->min[0],
             q->max[1] - q->min[1], q->max[2] - q->min[2]);
    cli_put_fact(out, "size", text);
    snprintf(text, sizeof text, "%.5g cm\xc2\xb2", q->area_mm2 / 100);
    cli_put_fact(out, "area", text);
    if (closed) {
        snprintf(text, sizeof text, "%.5g cm\xc2\xb3", q->volume_mm3 / 1000);
        cli_put_fact(out, "volume", text);
    }
    cli_put_fact(out, "unit",
                 m->mesh.file.known & CW_KNOWN_UNIT ? "as the file says" : "taken as mm");
    cli_put_fact(out, "source", cli_describe(m->study.volume));
    snprintf(text, sizeof text, "%s (%s)", cli_number_text(m->study.iso), m->study.level);
    cli_put_fact(out, "level", text);
    snprintf(text, sizeof text, "cubewright %s", cw_version());
    cli_put_fact(out, "measured by", text);
    fputs("</dl>\n", out);
}

static void put_distance(FILE *out, const char *name, const cw_distance *d, double voxel_mm)
{
    fprintf(out,
            "<tr><td class=\"w\">%s</td><td>%.3g</td><td>%.3g</td><td>%.3g</td><td>%.3g</td>"
            "<td>%.3g</td><td>%s</td></tr>",
            name, d->mean_mm, d->rms_mm, d->p99_mm, d->max_mm, d->max_mm / voxel_mm,
            cli_count(d->samples));
}

static void put_distances(FILE *out, const cli_mesh_study *m)
{
    fputs(
        "<h2>Distances</h2>\n<div class=\"wide\"><table><thead><tr><th class=\"w\">mm</th>"
        "<th>mean</th><th>RMS</th><th>99 %</th><th>max</th><th>max, voxels</th><th>points</th>"
        "</tr></thead><tbody>",
        out);
    put_distance(out, "from the mesh to the surface", &m->to_field, m->study.voxel_mm);
    put_distance(out, "from the surface to the mesh", &m->from_field, m->study.voxel_mm);
    fprintf(
        out,
        "</tbody></table></div>\n<p class=\"quiet\">To the surface: at points all over the "
        "mesh, those beyond 4 voxels count as 4 (%s of them). From the surface: at the "
        "vertices of the surface as extract makes it, which shows what the mesh lacks.</p>\n",
        cli_count(m->to_field.missed));
}

void cli_put_mesh_page(FILE *out, const void *study)
{
    const cli_mesh_study *m = study;
    char *command = cli_check_command(m);
    cli_put_page_begin(out, m->study.title);
    put_intro(out, m);
    put_mesh_facts(out, m);
    cli_put_overview(out, &m->study);
    cli_put_view(out, &m->study);
    cli_put_pictures(out, &m->study);
    put_distances(out, m);
    cli_put_looks(out, m);
    fputs("<h2>Checks</h2>\n<p>As check gives them: ", out);
    if (command)
        cli_put_code(out, command);
    fputs("</p>\n", out);
    cli_put_verdicts(out, m->verdicts, m->verdict_count);
    cli_put_quality(out, &m->study);
    cli_put_page_end(out);
    free(command);
}
