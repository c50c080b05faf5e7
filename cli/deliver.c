#include "cli/deliver.h"

#include "cli/console.h"
#include "cli/quantity.h"
#include "core/status.h"

#include <string.h>
#include <sys/stat.h>

/* The promise: closed unless --open, and a manifold without zero-area triangles in any case. */
static cw_status hold_to_promise(const cli_delivery *how, const cli_made *made, cw_error *err)
{
    const cw_quality *q = &made->quality;
    if (!q->nonmanifold_edges && !q->nonmanifold_vertices && !q->misoriented_edges &&
        !q->degenerate && (!q->open_edges || how->open))
        return CW_OK;
    return cw_fail(err, CW_ERR_CHECK,
                   "%s: the surface at %g is not as promised: %zu open, %zu non-manifold, %zu "
                   "misoriented edges, %zu non-manifold vertices, %zu degenerate triangles; "
                   "nothing is written (--no-check writes it)",
                   how->input, made->iso, q->open_edges, q->nonmanifold_edges,
                   q->misoriented_edges, q->nonmanifold_vertices, q->degenerate);
}

static cw_status check(cli_report *report, const cli_delivery *how, const cw_mesh *mesh,
                       cli_made *made, cw_error *err)
{
    cli_report_begin(report);
    cw_status st = cw_quality_measure(mesh, NULL, &made->quality, err);
    if (st != CW_OK)
        return st;
    cli_report_end(report, "check", mesh->triangle_count, mesh->triangle_count);
    made->measured = true;
    return hold_to_promise(how, made, err);
}

static void warn_of_loss(cli_report *report, const cli_made *made, const cw_mesh *mesh,
                         const cw_write_loss *loss)
{
    if (loss->merged_vertices || loss->flat_triangles)
        cli_report_warn(
            report,
            "%s: so far from zero single precision has steps of %.3g mm: %s of %s vertices "
            "fall together, %s of %s triangles lose their area; --local or .glb keeps them",
            cli_shown_path(made->path), loss->step_mm, cli_count(loss->merged_vertices),
            cli_count(mesh->vertex_count), cli_count(loss->flat_triangles),
            cli_count(mesh->triangle_count));
}

static cw_status write_mesh(cli_report *report, const cli_delivery *how, const cw_mesh *mesh,
                            cli_made *made, cw_error *err)
{
    cw_write_desc desc = how->write;
    cw_write_loss loss;
    desc.progress = cli_progress((double)mesh->triangle_count / 1e6, "Mtriangle");
    desc.compressed = &made->compressed;
    cli_set_compress(how->compress, mesh, how->voxel_mm, &desc);
    cli_report_begin(report);
    cw_status st = cw_mesh_write_loss(made->path, mesh, &desc, &loss, err);
    if (st == CW_OK)
        st = cw_mesh_write(made->path, mesh, &desc, err);
    if (st != CW_OK)
        return st;
    made->written = true;
    made->local = desc.local;
    made->compression = desc.compression;
    memcpy(made->origin, mesh->origin, sizeof made->origin);
    warn_of_loss(report, made, mesh, &loss);
    cli_report_end(report, "write", mesh->triangle_count, mesh->triangle_count);
    return CW_OK;
}

static void print_topology(const cli_delivery *how, const cw_quality *q, size_t border_loops)
{
    if (how->open)
        cli_result("; manifold, %s", q->open_edges ? "open at the volume's border" : "closed");
    else if (border_loops)
        cli_result("; closed (%s %s at the volume's border capped), manifold",
                   cli_count(border_loops), border_loops == 1 ? "loop" : "loops");
    else
        cli_result("; closed, manifold");
    cli_result("; %s %s; box %.6g x %.6g x %.6g mm", cli_count(q->components),
               q->components == 1 ? "component" : "components", q->max[0] - q->min[0],
               q->max[1] - q->min[1], q->max[2] - q->min[2]);
}

static void print_compressed(const cli_made *made)
{
    const cw_compressed *c = &made->compressed;
    cli_result("; %s", cli_compression_name(made->compression));
    if (c->bits)
        cli_result(" of %d bits, off by at most %.3g mm", c->bits, c->error_mm);
    else
        cli_result(", positions as they were");
    cli_result(", decoded and checked");
}

static void print_summary(const cli_delivery *how, const cli_made *made, const cw_mesh *mesh,
                          size_t border_loops, double start)
{
    struct stat info = {0};
    stat(made->path, &info);
    cli_result("%s: %s vertices, %s triangles, %s", made->path, cli_count(mesh->vertex_count),
               cli_count(mesh->triangle_count), cli_bytes((double)info.st_size));
    if (made->measured)
        print_topology(how, &made->quality, border_loops);
    if (made->snapped)
        cli_result("; %s vertices merged, off by at most %.3g mm, %.2g voxels",
                   cli_count(made->snap.vertices), made->snap.max_error_mm,
                   made->snap.max_error_voxels);
    if (made->local)
        cli_result("; relative to %.15g, %.15g, %.15g mm", made->origin[0], made->origin[1],
                   made->origin[2]);
    if (made->compression)
        print_compressed(made);
    if (how->preview)
        cli_result("; a preview");
    cli_result("; %.2f s\n", cli_seconds() - start);
}

/* Bits that were stated are used, whatever they do to the shape; but it is told. */
static cw_status hold_to_shape(const cli_made *made, cw_error *err)
{
    const cw_compressed *c = &made->compressed;
    if (!c->merged && !c->flat)
        return CW_OK;
    return cw_fail(err, CW_ERR_CHECK,
                   "%s: with %d bits %s vertices fall onto others and %s triangles lose their "
                   "area; without --bits there are as many as it takes",
                   cli_shown_path(made->path), c->bits, cli_count(c->merged),
                   cli_count(c->flat));
}

cw_status cli_deliver(cli_report *report, const cli_delivery *how, const cw_mesh *mesh,
                      size_t border_loops, double start, cw_error *err)
{
    cli_made *made = &report->made[report->made_count - 1];
    cw_status st = how->unchecked ? CW_OK : check(report, how, mesh, made, err);
    if (st == CW_OK)
        st = write_mesh(report, how, mesh, made, err);
    if (st == CW_OK)
        print_summary(how, made, mesh, border_loops, start);
    return st == CW_OK ? hold_to_shape(made, err) : st;
}
