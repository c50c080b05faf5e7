/* The rows for people, as CSV and as JSON. */
#include "cli/bench/bench.h"

#include "cli/framework/console.h"
#include "cli/framework/json_writer.h"
#include "cli/framework/quantity.h"

#include <math.h>
#include <string.h>
#include <unistd.h>

static const char *const work_names[CLI_BENCH_WORKS] = {"extraction", "simplification",
                                                        "compression"};

/* --- for people --------------------------------------------------------------------------- */

void cli_bench_tell_start(const cli_bench *b)
{
    const char *before = "; beside ";
    cli_result("cubewright %s, %d of %ld processors", cw_version(), b->threads,
               sysconf(_SC_NPROCESSORS_ONLN));
    if (isfinite(b->load))
        cli_result(" (load before: %.1f)", b->load);
    cli_result("; median of %zu run%s", b->repeat, b->repeat == 1 ? "" : "s");
    for (int n = 0; n < CLI_PEER_COUNT && b->with_peers; n++) {
        const cli_peer *p = &b->peers.of[n];
        if (p->state != CLI_PEER_READY)
            continue;
        cli_result("%s%s%s%s", before, p->name, *p->version ? " " : "", p->version);
        before = ", ";
    }
    cli_result("%s\n", b->with_peers && *before == ';' ? "; no peer is installed" : "");
}

/* A cell of the table; empty when there is nothing to tell. */
static void tell_cell(int width, bool known, const char *text)
{
    cli_result(" %*s", width, known ? text : "");
}

static void tell_number(int width, bool known, int decimals, double value)
{
    char text[32];
    snprintf(text, sizeof text, "%.*f", decimals, value);
    tell_cell(width, known, text);
}

static void tell_error(bool known, double value)
{
    char text[32];
    snprintf(text, sizeof text, "%.2g", value);
    tell_cell(9, known, text);
}

static double mega_triangles_per_second(const cli_bench_row *r)
{
    return r->seconds > 0 ? 1e-6 * (double)r->worked_on / r->seconds : 0;
}

static void tell_defects(const cli_bench_row *r)
{
    if (r->nonmanifold_edges)
        cli_result("  %s non-manifold edges", cli_count(r->nonmanifold_edges));
    if (r->nonmanifold_vertices)
        cli_result("  %s non-manifold vertices", cli_count(r->nonmanifold_vertices));
    if (r->zero_area)
        cli_result("  %s triangles without area", cli_count(r->zero_area));
    if (r->at_vertices.missed)
        cli_result("  %s vertices with no surface nearby", cli_count(r->at_vertices.missed));
}

static void tell_row(const cli_bench_row *r)
{
    char name[96];
    const cw_field_vertex_error *v = &r->at_vertices;
    snprintf(name, sizeof name, "%s, %s", r->who, r->setting);
    if (r->status != CLI_BENCH_DONE) {
        cli_result("  %-38s %s: %s\n", name, cli_bench_status_names[r->status], r->why);
        return;
    }
    cli_result("  %-38s", name);
    tell_number(9, true, r->seconds < 0.01 ? 3 : 1, 1e3 * r->seconds);
    tell_number(6, r->ratio > 0, 2, r->ratio);
    tell_number(7, r->seconds > 0, 2, mega_triangles_per_second(r));
    tell_cell(9, r->peak_bytes > 0, cli_bytes((double)r->peak_bytes));
    if (r->work == CLI_BENCH_COMPRESSION) {
        tell_cell(11, true, cli_bytes((double)r->file_bytes));
        tell_error(r->moved, r->moved_mean_mm);
        tell_error(r->moved, r->moved_max_mm);
    } else {
        tell_cell(11, true, cli_count(r->triangles));
        tell_error(v->count > 0, v->mean_mm);
        tell_error(v->count > 0, v->max_mm);
    }
    tell_error(r->surface.known, r->surface.rms_mm);
    tell_error(v->has_normals, v->mean_deg);
    tell_defects(r);
    cli_result("\n");
}

static void tell_heading(cli_bench_work work)
{
    const bool packed = work == CLI_BENCH_COMPRESSION;
    cli_result("  %-38s %9s %6s %7s %9s %11s %9s %9s %9s %9s\n", work_names[work], "ms",
               "times", "Mtri/s", "memory", packed ? "file" : "triangles",
               packed ? "moved mm" : "off by mm", "at most", "surface", "normals");
}

void cli_bench_tell(const cli_bench_case *c)
{
    cli_result("\n%s, %zu x %zu x %zu %s, --iso %s (%s), voxels of %.3g mm\n", c->name,
               c->dim[0], c->dim[1], c->dim[2], cw_type_name(c->type), cli_number_text(c->iso),
               c->level, c->voxel_mm);
    for (size_t n = 0; n < c->row_count; n++) {
        if (n == 0 || c->rows[n].work != c->rows[n - 1].work)
            tell_heading(c->rows[n].work);
        tell_row(&c->rows[n]);
    }
}

/* --- for programs ------------------------------------------------------------------------- */

/* A file's name is somebody else's: spreadsheets take some first letters for formulas. */
static void put_case(FILE *out, const cli_bench_case *c)
{
    char name[4096];
    snprintf(name, sizeof name, "%s%s", strchr("=+-@\t\r", *c->name) ? "./" : "", c->name);
    cli_put_cell(out, name);
}

static void put_row(FILE *out, const cli_bench_case *c, const cli_bench_row *r)
{
    const bool done = r->status == CLI_BENCH_DONE, missed = r->at_vertices.missed > 0;
    const cw_field_vertex_error *v = &r->at_vertices;
    put_case(out, c);
    fprintf(out, ",%zu,%zu,%zu,%s,%s,", c->dim[0], c->dim[1], c->dim[2],
            cli_number_text(c->iso), work_names[r->work]);
    cli_put_cell(out, r->who);
    fputc(',', out);
    cli_put_cell(out, r->setting);
    fprintf(out, ",%s,%d", cli_bench_status_names[r->status], r->threads);
    cli_put_number(out, done, r->seconds);
    cli_put_number(out, done, mega_triangles_per_second(r));
    cli_put_number(out, done && r->ratio > 0, r->ratio);
    cli_put_number(out, done && r->peak_bytes > 0, (double)r->peak_bytes);
    cli_put_number(out, done, (double)r->triangles);
    cli_put_number(out, done && r->file_bytes > 0, (double)r->file_bytes);
    cli_put_number(out, v->count > 0, v->mean_mm);
    cli_put_number(out, v->count > 0, v->max_mm);
    cli_put_number(out, missed, (double)v->missed);
    cli_put_number(out, v->has_normals, v->mean_deg);
    cli_put_number(out, v->has_normals, v->max_deg);
    cli_put_number(out, r->surface.known, r->surface.rms_mm);
    cli_put_number(out, r->surface.known, r->surface.max_mm);
    cli_put_number(out, r->moved, r->moved_mean_mm);
    cli_put_number(out, r->moved, r->moved_max_mm);
    cli_put_number(out, done, (double)r->open_edges);
    cli_put_number(out, done, (double)r->nonmanifold_edges);
    cli_put_number(out, done, (double)r->nonmanifold_vertices);
    cli_put_number(out, done, (double)r->zero_area);
    fputc(',', out);
    cli_put_cell(out, r->why);
    fputs("\r\n", out);
}

void cli_bench_put_csv(FILE *out, const void *bench)
{
    const cli_bench *b = bench;
    fputs("case,nx,ny,nz,iso,work,who,setting,status,threads,seconds,mtriangles_per_second,"
          "ratio,peak_bytes,"
          "triangles,file_bytes,vertices_mean_mm,vertices_max_mm,vertices_missed,"
          "normals_mean_deg,normals_max_deg,surface_rms_mm,surface_max_mm,moved_mean_mm,"
          "moved_max_mm,open_edges,nonmanifold_edges,nonmanifold_vertices,zero_area,note\r\n",
          out);
    for (size_t n = 0; n < b->case_count; n++)
        for (size_t r = 0; r < b->cases[n].row_count; r++)
            put_row(out, &b->cases[n], &b->cases[n].rows[r]);
}

static void json_errors(cli_json *j, const cli_bench_row *r)
{
    const cw_field_vertex_error *v = &r->at_vertices;
    cli_json_open(j, "vertices_off", '{');
    cli_json_count(j, "measured", v->count);
    cli_json_count(j, "missed", v->missed);
    cli_json_number(j, "mean_mm", v->mean_mm);
    cli_json_number(j, "max_mm", v->max_mm);
    cli_json_close(j, '}');
    if (v->has_normals) {
        cli_json_open(j, "normals_off", '{');
        cli_json_number(j, "mean_deg", v->mean_deg);
        cli_json_number(j, "max_deg", v->max_deg);
        cli_json_close(j, '}');
    }
    if (r->surface.known) {
        cli_json_open(j, "surface_off", '{');
        cli_json_number(j, "rms_mm", r->surface.rms_mm);
        cli_json_number(j, "max_mm", r->surface.max_mm);
        cli_json_close(j, '}');
    }
    if (r->moved) {
        cli_json_open(j, "moved", '{');
        cli_json_number(j, "mean_mm", r->moved_mean_mm);
        cli_json_number(j, "max_mm", r->moved_max_mm);
        cli_json_close(j, '}');
    }
}

static void json_row(cli_json *j, const cli_bench_row *r)
{
    cli_json_open(j, NULL, '{');
    cli_json_text(j, "work", work_names[r->work]);
    cli_json_text(j, "who", r->who);
    cli_json_text(j, "setting", r->setting);
    cli_json_text(j, "status", cli_bench_status_names[r->status]);
    cli_json_int(j, "threads", r->threads);
    if (r->status != CLI_BENCH_DONE) {
        cli_json_text(j, "note", r->why);
        cli_json_close(j, '}');
        return;
    }
    cli_json_number(j, "seconds", r->seconds);
    cli_json_numbers(j, "runs", r->times, r->runs);
    cli_json_number(j, "mtriangles_per_second", mega_triangles_per_second(r));
    if (r->ratio > 0) {
        cli_json_number(j, "ratio", r->ratio);
        cli_json_text(j, "ratio_to", r->against);
    }
    if (r->peak_bytes)
        cli_json_count(j, "peak_bytes", r->peak_bytes);
    cli_json_count(j, "vertices", r->vertices);
    cli_json_count(j, "triangles", r->triangles);
    if (r->file_bytes)
        cli_json_count(j, "file_bytes", r->file_bytes);
    json_errors(j, r);
    cli_json_count(j, "open_edges", r->open_edges);
    cli_json_count(j, "nonmanifold_edges", r->nonmanifold_edges);
    cli_json_count(j, "nonmanifold_vertices", r->nonmanifold_vertices);
    cli_json_count(j, "zero_area", r->zero_area);
    cli_json_close(j, '}');
}

static void json_case(cli_json *j, const cli_bench_case *c)
{
    const double dims[3] = {(double)c->dim[0], (double)c->dim[1], (double)c->dim[2]};
    cli_json_open(j, NULL, '{');
    cli_json_text(j, c->path ? "file" : "field", c->name);
    cli_json_numbers(j, "dims", dims, 3);
    cli_json_text(j, "type", cw_type_name(c->type));
    cli_json_number(j, "iso", c->iso);
    cli_json_text(j, "level", c->level);
    cli_json_text(j, "inside", c->inside_is_low ? "below" : "above");
    cli_json_number(j, "voxel_mm", c->voxel_mm);
    cli_json_text(j, "truth", c->path ? "the field between the voxels" : "on paper");
    cli_json_open(j, "rows", '[');
    for (size_t n = 0; n < c->row_count; n++)
        json_row(j, &c->rows[n]);
    cli_json_close(j, ']');
    cli_json_close(j, '}');
}

static void json_peer(cli_json *j, const cli_peer *p)
{
    static const char *const states[] = {"untried", "ready", "missing", "failed"};
    cli_json_open(j, NULL, '{');
    cli_json_text(j, "name", p->name);
    cli_json_text(j, "state", states[p->state]);
    if (*p->version)
        cli_json_text(j, "version", p->version);
    if (p->state != CLI_PEER_READY)
        cli_json_text(j, "note", p->why);
    cli_json_text(j, "package", p->package);
    cli_json_close(j, '}');
}

void cli_bench_put_json(FILE *out, const void *bench)
{
    const cli_bench *b = bench;
    cli_json j = {.out = out};
    cli_json_open(&j, NULL, '{');
    cli_json_text(&j, "schema", "cubewright-bench-1");
    cli_json_text(&j, "tool", "cubewright");
    cli_json_text(&j, "version", cw_version());
    cli_json_int(&j, "threads", b->threads);
    cli_json_int(&j, "processors", sysconf(_SC_NPROCESSORS_ONLN));
    cli_json_number(&j, "load_before", b->load);
    cli_json_count(&j, "repeat", b->repeat);
    cli_json_open(&j, "peers", '[');
    for (int n = 0; n < CLI_PEER_COUNT && b->with_peers; n++)
        json_peer(&j, &b->peers.of[n]);
    cli_json_close(&j, ']');
    cli_json_open(&j, "cases", '[');
    for (size_t n = 0; n < b->case_count; n++)
        json_case(&j, &b->cases[n]);
    cli_json_close(&j, ']');
    cli_json_close(&j, '}');
}
