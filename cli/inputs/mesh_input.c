/* Reads meshes for commands, prints what was found in them, and turns shells that face the
 * wrong way. */
#include "cli/inputs/mesh_input.h"

#include "cli/framework/console.h"
#include "cli/framework/quantity.h"
#include "cli/framework/standard_streams.h"
#include "core/base/status.h"

#include <cubewright/atlas.h>
#include <cubewright/quality.h>

#include <sha2.h>
#include <sys/stat.h>

size_t cli_mesh_triangles(const cli_mesh *m)
{
    size_t triangles = m->mesh.triangle_count;
    for (size_t p = 0; p < m->part_count; p++)
        triangles += m->parts[p].mesh->triangle_count;
    return triangles;
}

static void say_left_out(const cli_mesh *m, size_t objects, size_t triangles, const char *which)
{
    if (objects)
        cli_say("%s: %zu object%s %s, with %s triangles, left out", m->path, objects,
                objects == 1 ? "" : "s", which, cli_count(triangles));
}

static void say_truncated(const cli_mesh *m)
{
    if (!m->file.truncated)
        return;
    char of[64] = "";
    if (m->file.expected_triangles)
        snprintf(of, sizeof of, " of %s", cli_count(m->file.expected_triangles));
    cli_say("%s: the file breaks off: took %s%s facets", m->path,
            cli_count(cli_mesh_triangles(m)), of);
}

static void say_miscounted(const cli_mesh *m)
{
    if (m->file.miscounted)
        cli_say("%s: the header counts %s facets; the file's size tells %s, which are taken",
                m->path, cli_count(m->file.expected_triangles),
                cli_count(cli_mesh_triangles(m)));
    if (m->file.attribute_bytes)
        cli_say("%s: %s bytes of attributes behind the facets left out", m->path,
                cli_count((size_t)m->file.attribute_bytes));
}

static void say_pieces(const cli_mesh *m)
{
    const cw_mesh_file *f = &m->file;
    if (f->pieces)
        cli_say("%s: %zu pieces read; %s vertices on their seams are one with others", m->path,
                f->pieces, cli_count(f->merged_vertices));
    if (f->marked_cells)
        cli_say("%s: %s cells left out, as they are hidden or another piece's", m->path,
                cli_count(f->marked_cells));
}

static void say_what_was_found(const cli_mesh *m)
{
    size_t vertices = m->mesh.vertex_count;
    for (size_t p = 0; p < m->part_count; p++)
        vertices += m->parts[p].mesh->vertex_count;
    cli_say("%s: %s, %s vertices, %s triangles%s", m->path, m->file.format, cli_count(vertices),
            cli_count(cli_mesh_triangles(m)),
            m->file.known & CW_KNOWN_UNIT ? "" : " (no unit given: taken as mm)");
    say_truncated(m);
    say_miscounted(m);
    say_pieces(m);
    if (*m->file.placed)
        cli_say("%s: placed in the frame of the scanner by %s", m->path, m->file.placed);
    if (m->part_count > 1)
        cli_say("%s: %zu parts", m->path, m->part_count);
    else if (!m->parts && m->file.parts > 1)
        cli_say("%s: %zu parts, taken as one mesh", m->path, m->file.parts);
    if (m->file.polygons)
        cli_say("%s: %s polygons cut into triangles", m->path, cli_count(m->file.polygons));
    if (m->file.crossing)
        cli_say("%s: %s of the polygons cross themselves: their triangles overlap", m->path,
                cli_count(m->file.crossing));
    if (m->file.skipped)
        cli_say("%s: %s points and lines left out", m->path, cli_count(m->file.skipped));
    if (m->file.levels)
        cli_say("%s: %zu coarser level%s of detail left out", m->path, m->file.levels,
                m->file.levels == 1 ? "" : "s");
    if (m->file.hidden)
        cli_say("%s: %zu part%s hidden by a scale of 0, as an animation does, left out",
                m->path, m->file.hidden, m->file.hidden == 1 ? "" : "s");
    if (m->file.invisible)
        cli_say("%s: %zu part%s hidden by KHR_node_visibility left out%s%s", m->path,
                m->file.invisible, m->file.invisible == 1 ? "" : "s",
                m->file.invisible_names[0] ? ": " : "", m->file.invisible_names);
    if (m->file.fault[0])
        cli_say("%s: the file breaks a rule of glTF, and is read all the same: %s", m->path,
                m->file.fault);
    if (m->file.not_applied[0])
        cli_say("%s: drawn otherwise by viewers, since these are not applied: %s", m->path,
                m->file.not_applied);
    if (m->file.modifier_triangles)
        cli_say(
            "%s: modifiers of the slicer, with %s triangles, left out: they are no parts of the print",
            m->path, cli_count(m->file.modifier_triangles));
    if (*m->file.left_out)
        cli_say("%s: left out, because a mesh cannot hold them: %s", m->path, m->file.left_out);
    say_left_out(m, m->file.supports, m->file.support_triangles, "for support");
    say_left_out(m, m->file.others, m->file.other_triangles, "of type 'other'");
}

bool cli_is_textured(const cli_mesh *m)
{
    bool found = cw_mesh_attribute_find(&m->mesh, CW_TEXTURE_COORDINATES);
    for (size_t p = 0; p < m->part_count; p++)
        found = found || cw_mesh_attribute_find(m->parts[p].mesh, CW_TEXTURE_COORDINATES);
    return found;
}

/* Reads the pictures of a textured mesh that is merged: one mesh has one set of them. */
static cw_status read_pictures(const char *path, const cw_mesh_read_desc *desc, cli_mesh *m,
                               cw_error *err)
{
    bool differ = false;
    cw_status st = cw_parts_read(path, desc, &m->pictured, &m->pictured_count, NULL, err);
    for (size_t p = 1; st == CW_OK && p < m->pictured_count; p++)
        differ = differ || m->pictured[p].textures != m->pictured->textures;
    if (st == CW_OK && differ)
        cli_say("%s: pictures left out: %zu parts have several, and are taken as one mesh",
                path, m->pictured_count);
    else if (st == CW_OK && m->pictured_count)
        m->textures = m->pictured->textures;
    return st;
}

static cw_mesh_read_desc make_desc(const char *path, const char *reader, const cli_input *input,
                                   bool reference)
{
    double bytes;
    cli_find_input_size(path, &bytes);
    cw_mesh_read_desc desc = {
        .stored = cli_stored_input(path),
        .reader = reader,
        .allow_external = input->allow_external,
        .truncated = input->truncated,
        .max_triangles = input->max_triangles,
        .max_bytes = cli_memory_limit(input),
        .no_sandbox = input->no_sandbox,
        .timeout_s = (double)input->timeout_s,
        .claim = cli_claim_of(&input->claim),
    };
    if (reference)
        desc.claim.rule = CW_CLAIM_FILL;
    desc.progress = cli_progress(bytes / 1e6, "MB");
    return desc;
}

static cw_status read_file(const char *path, const char *reader, const cli_input *input,
                           bool parts, bool reference, cli_mesh *mesh, cw_error *err)
{
    const cw_mesh_read_desc desc = make_desc(path, reader, input, reference);
    *mesh = (cli_mesh){.path = path};
    cw_status st =
        parts ? cw_parts_read(path, &desc, &mesh->parts, &mesh->part_count, &mesh->file, err)
              : cw_mesh_read(path, &desc, &mesh->mesh, &mesh->file, err);
    if (st == CW_OK)
        say_what_was_found(mesh);
    if (st == CW_OK && !parts && !reference && cli_is_textured(mesh))
        st = read_pictures(path, &desc, mesh, err);
    return st;
}

cw_status cli_read_mesh(const char *path, const char *reader, const cli_input *input,
                        cli_mesh *mesh, cw_error *err)
{
    return read_file(path, reader, input, false, false, mesh, err);
}

cw_status cli_read_reference(const char *path, const char *reader, const cli_input *input,
                             cli_mesh *mesh, cw_error *err)
{
    return read_file(path, reader, input, false, true, mesh, err);
}

cw_status cli_read_parts(const char *path, const char *reader, const cli_input *input,
                         cli_mesh *mesh, cw_error *err)
{
    return read_file(path, reader, input, true, false, mesh, err);
}

cw_status cli_read_parts_again(const cli_mesh *whole, bool is_reference, const char *reader,
                               const cli_input *input, cli_mesh *parts, cw_error *err)
{
    const cw_mesh_read_desc desc = make_desc(whole->path, reader, input, is_reference);
    *parts = (cli_mesh){.path = whole->path};
    return cw_parts_read(whole->path, &desc, &parts->parts, &parts->part_count, &parts->file,
                         err);
}

cw_status cli_orient_mesh(cli_mesh *m, int threads, cw_error *err)
{
    size_t turned = 0;
    cw_status st = CW_OK;
    for (size_t p = 0; p < (m->parts ? m->part_count : 1) && st == CW_OK; p++) {
        cw_orient_counts counts;
        cw_mesh *mesh = m->parts ? (cw_mesh *)(uintptr_t)m->parts[p].mesh : &m->mesh;
        st = cw_mesh_orient(mesh, threads, &counts, err);
        turned += counts.turned;
    }
    if (st != CW_OK)
        return cwi_fail_in(err, st, m->path);
    cli_say("%s: %s shell%s flipped", m->path, cli_count(turned), turned == 1 ? "" : "s");
    return CW_OK;
}

void cli_free_mesh(cli_mesh *mesh)
{
    cw_mesh_free(&mesh->mesh);
    cw_parts_free(mesh->parts, mesh->part_count);
    cw_parts_free(mesh->pictured, mesh->pictured_count);
    mesh->pictured = NULL;
    mesh->pictured_count = 0;
    mesh->parts = NULL;
    mesh->part_count = 0;
}

void cli_json_mesh_file(cli_json *j, const char *key, const cli_mesh *mesh)
{
    char sum[SHA256_DIGEST_STRING_LENGTH];
    cli_json_open(j, key, '{');
    cli_json_text(j, "path", cli_shown_path(mesh->path));
    cli_json_text(j, "kind", mesh->file.format);
    cli_json_count(j, "parts", mesh->file.parts);
    const cw_axes *axes = &mesh->file.axes;
    cli_json_text(j, "unit",
                  mesh->file.known & CW_KNOWN_UNIT ? cw_unit_name(axes->unit) : "unknown");
    cli_json_text(j, "frame",
                  !(mesh->file.known & CW_KNOWN_FRAME) ? "unknown"
                  : axes->ras                          ? "RAS"
                                                       : "LPS");
    if (mesh->file.truncated) {
        cli_json_bool(j, "truncated", true);
        cli_json_count(j, "expected_triangles", mesh->file.expected_triangles);
    }
    if (axes->y_up)
        cli_json_text(j, "up", "y");
    if (*mesh->file.left_out)
        cli_json_text(j, "left_out", mesh->file.left_out);
    if (SHA256File(cli_bytes_path(mesh->path), sum))
        cli_json_text(j, "sha256", sum);
    cli_json_close(j, '}');
}
