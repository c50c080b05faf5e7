/* Writes meshes: finds the writer, checks the request, and measures the loss of a file. */
#include <cubewright/formats.h>

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/files/temporary_name.h"
#include "formats/bytes/file_pattern.h"
#include "formats/format_registry.h"
#include "formats/gltf/gltf_formats.h"
#include "formats/mesh/place_parts.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *written_extensions(const cwi_format_driver *f)
{
    return f->write.extensions ? f->write.extensions : f->extensions;
}

/* Returns the writer's index among the formats, or the number of formats when there is none. */
static size_t find_writer(const char *path, const char *name)
{
    const cwi_format_driver *f;
    size_t n = 0;
    for (; (f = cwi_format_at(n)) != NULL; n++)
        if (f->write.write && (name ? strcmp(f->name, name) == 0
                                    : cwi_has_extension(path, written_extensions(f))))
            break;
    return n;
}

const cw_format *cw_mesh_format(const char *path, const char *name)
{
    size_t count;
    const cw_format *all = cw_formats(&count);
    if (!path && !name)
        return NULL;
    const size_t n = find_writer(path, name);
    return n < count ? &all[n] : NULL;
}

static const char *writer_name(const cwi_format_driver *f)
{
    return f->write.write ? f->name : NULL;
}

static const char *writer_extensions(const cwi_format_driver *f)
{
    return f->write.write && *f->extensions ? written_extensions(f) : NULL;
}

static const char *text_writer_name(const cwi_format_driver *f)
{
    return f->write.text ? f->name : NULL;
}

static cw_status fail_unknown(const char *name, cw_error *err)
{
    char list[CWI_FORMAT_LIST];
    if (name)
        return cwi_fail(err, CW_ERR_ARGUMENT, "no mesh format is named '%s'; there are %s",
                        name, cwi_list_formats(writer_name, " ", list));
    return cwi_fail(err, CW_ERR_ARGUMENT, "its extension is of no mesh format; there are %s",
                    cwi_list_formats(writer_extensions, " ", list));
}

/* Checks the axes. For glTF the axes that it always has may be requested. */
static cw_status check_axes(const cwi_format_driver *f, const cw_axes *axes, cw_error *err)
{
    const bool metres = axes->unit == CW_UNIT_MM || axes->unit == CW_UNIT_M;
    if (axes->unit >= CW_UNIT_COUNT)
        return cwi_fail(err, CW_ERR_ARGUMENT, "%d is not a unit", (int)axes->unit);
    if (f->write.own_axes && (!metres || axes->ras))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "%s is in metres, +Y up and facing +Z: it has no other unit or frame",
                        f->name);
    if (f->write.ras_mm && (axes->unit != CW_UNIT_MM || axes->y_up))
        return cwi_fail(
            err, CW_ERR_ARGUMENT,
            "%s is in millimetres, right-anterior-superior: it has no other unit or "
            "frame",
            f->name);
    return CW_OK;
}

static cw_status check_text(const cwi_format_driver *f, const cw_write_desc *d, cw_error *err)
{
    char list[CWI_FORMAT_LIST];
    return !d->text || f->write.text
               ? CW_OK
               : cwi_fail(err, CW_ERR_ARGUMENT,
                          "%s has no form as text; those that have are %s", f->name,
                          cwi_list_formats(text_writer_name, " ", list));
}

static cw_status check_compression(const cwi_format_driver *f, const cw_write_desc *d,
                                   cw_error *err)
{
    cw_write_desc as_written = *d;
    if (f->write.only && d->compression && d->compression != f->write.only)
        return cwi_fail(err, CW_ERR_ARGUMENT, "%s has one form only, Draco's", f->name);
    if (f->write.only)
        as_written.compression = f->write.only;
    if (as_written.compression == CW_COMPRESS_NONE)
        return CW_OK;
    if (f->write.compresses || f->write.only)
        return cwi_gltf_prepare_codec(&as_written, err);
    return cwi_fail(err, CW_ERR_ARGUMENT, "%s has no compressed form; glTF (.glb, .gltf) has",
                    f->name);
}

static cw_status check_animation(const cwi_format_driver *f, const cw_write_desc *d,
                                 cw_error *err)
{
    return !d->animated || f->write.animates
               ? CW_OK
               : cwi_fail(err, CW_ERR_ARGUMENT, "%s has no animation; glTF (.glb, .gltf) has",
                          f->name);
}

static cw_status check_sides(const cwi_format_driver *f, const cw_write_desc *d, cw_error *err)
{
    return !d->sides || f->write.sides
               ? CW_OK
               : cwi_fail(err, CW_ERR_ARGUMENT,
                          "%s has no labels on both sides of triangles; vtp and ply have",
                          f->name);
}

/* Finds the format and writer of a path, loads its modules, and checks that it supports the
 * request. */
static cw_status prepare_writer(const char *path, const cw_write_desc *d,
                                const cwi_format_driver **out, cw_error *err)
{
    const cwi_format_driver *f = *out = cwi_format_at(find_writer(path, d->format));
    if (!f)
        return fail_unknown(d->format, err);
    cw_status st = check_axes(f, &d->axes, err);
    if (st == CW_OK)
        st = check_text(f, d, err);
    if (st == CW_OK)
        st = check_animation(f, d, err);
    if (st == CW_OK)
        st = check_sides(f, d, err);
    if (st == CW_OK)
        st = check_compression(f, d, err);
    if (st == CW_OK && f->write.check)
        st = f->write.check(d, err);
    return st == CW_OK && f->write.prepare ? f->write.prepare(err) : st;
}

static const char *spool_writer_name(const cwi_format_driver *f)
{
    return f->write.spools ? f->name : NULL;
}

static cw_status check_spools(const cwi_format_driver *f, const cw_part *parts, size_t count,
                              const cw_write_desc *d, cw_error *err)
{
    char list[CWI_FORMAT_LIST];
    bool any = false;
    for (size_t i = 0; i < count; i++)
        any = any || parts[i].spool;
    if (any && !f->write.spools)
        return cwi_fail(err, CW_ERR_UNSUPPORTED,
                        "%s is not written piece by piece, as a surface larger than memory is; "
                        "those that are: %s",
                        f->name, cwi_list_formats(spool_writer_name, " ", list));
    return any && d->compression != CW_COMPRESS_NONE
               ? cwi_fail(
                     err, CW_ERR_UNSUPPORTED,
                     "a surface larger than memory is not compressed; 'convert' compresses "
                     "a file of it that fits")
               : CW_OK;
}

static cw_status check_levels(const cwi_format_driver *f, const cw_part *parts, size_t count,
                              cw_error *err)
{
    for (size_t i = 0; i < count; i++) {
        const size_t level = parts[i].level;
        if (level == 0)
            continue;
        if (!f->write.levels)
            return cwi_fail(
                err, CW_ERR_ARGUMENT,
                "%s has no levels of detail; glTF (.glb, .gltf) and neuroglancer have",
                f->name);
        if (i == 0 || parts[i - 1].level != level - 1)
            return cwi_fail(err, CW_ERR_ARGUMENT,
                            "part %zu is of level %zu: one of level %zu must be "
                            "in front of it",
                            i, level, level - 1);
        if (!parts[i].mesh->triangle_count || !parts[i - 1].mesh->triangle_count)
            return cwi_fail(err, CW_ERR_ARGUMENT, "a level of detail has no triangles");
    }
    return CW_OK;
}

/* Returns the properties of a mesh that the file will keep. */
static unsigned keeps_of(const cwi_format_driver *f, const cw_write_desc *d)
{
    return f->keeps & ~(d->text ? f->write.text_lacks : 0u);
}

static cw_status open_output(const char *path, const cwi_format_driver *f,
                             const cw_write_desc *d, cwi_mesh_output *out, cw_error *err)
{
    if (d->sink && f->write.replaces)
        return cwi_fail(err, CW_ERR_UNSUPPORTED,
                        "%s is a folder of many files, which no sink takes (desc->sink)",
                        f->name);
    if (d->sink)
        return cwi_byte_output_open(&out->bytes, d->sink, &out->file, err);
    return f->write.replaces
               ? cwi_outfolder_open(&out->folder, path, d->no_clobber, f->write.replaces, err)
               : cwi_outfile_open(&out->file, path, d->no_clobber, err);
}

static void abort_output(cwi_mesh_output *out)
{
    for (size_t n = 0; n < out->picture_count; n++)
        cwi_outfile_abort(&out->pictures[n]);
    cwi_free(out->pictures);
    out->pictures = NULL;
    out->picture_count = 0;
    cwi_outfile_abort(&out->side);
    cwi_outfile_abort(&out->file);
    cwi_outfolder_abort(&out->folder);
    cwi_byte_output_close(&out->bytes);
}

/* Opens the temporary of rank 0 in all processes of a team. */
static cw_status open_shared(const char *path, const cw_team *team, const cw_write_desc *d,
                             cwi_mesh_output *out, cw_error *err)
{
    char name[CWI_FILE_NAME_BYTES] = "";
    cw_status st =
        team->rank == 0 ? cwi_outfile_open(&out->file, path, d->no_clobber, err) : CW_OK;
    if (out->file)
        strcpy(name, cwi_outfile_temporary(out->file));
    st = cw_team_agree(team, st, err);
    if (st == CW_OK)
        st = cw_team_broadcast(team, 0, name, sizeof name, err);
    if (st == CW_OK && team->rank > 0)
        st = cwi_outfile_join(&out->file, path, name, err);
    return cw_team_agree(team, st, err);
}

/* Writes a file by all processes of a team, each the records of its part. */
static cw_status write_shared(const char *path, const cwi_parts *parts,
                              const cwi_format_driver *f, const cw_team *team,
                              const cw_write_desc *d, cwi_mesh_output *out, cw_error *err)
{
    out->shared = true;
    cw_status st = open_shared(path, team, d, out, err);
    if (st == CW_OK) {
        st = f->write.write(parts, out, err);
        if (st == CW_OK && team->rank > 0)
            st = cwi_outfile_commit(&out->file, err);
        st = cw_team_agree(team, st, err);
    }
    if (st == CW_OK)
        st = cw_team_agree(team, team->rank == 0 ? cwi_outfile_commit(&out->file, err) : CW_OK,
                           err);
    abort_output(out);
    return st;
}

/* Asks for consent once nothing is left to do but to put the files in place. */
static cw_status ask_consent(const cw_write_consent *consent, cwi_mesh_output *out,
                             cw_error *err)
{
    cw_status st = out->side ? cwi_outfile_finish(out->side, err) : CW_OK;
    for (size_t n = 0; n < out->picture_count && st == CW_OK; n++)
        st = cwi_outfile_finish(out->pictures[n], err);
    if (st == CW_OK && out->file)
        st = cwi_outfile_finish(out->file, err);
    return st == CW_OK ? consent->ask(consent->user, err) : st;
}

static cw_status write_parts(const char *path, const cwi_parts *parts,
                             const cwi_format_driver *f, const cw_write_desc *d,
                             const cw_write_consent *consent, cwi_mesh_output *out,
                             cw_error *err)
{
    cw_status st = open_output(path, f, d, out, err);
    if (st == CW_OK)
        st = f->write.write(parts, out, err);
    if (st == CW_OK && consent)
        st = ask_consent(consent, out, err);
    for (size_t n = 0; n < out->picture_count && st == CW_OK; n++)
        st = cwi_outfile_commit(&out->pictures[n], err);
    if (st == CW_OK && out->side)
        st = cwi_outfile_commit(&out->side, err);
    if (st == CW_OK)
        st = out->folder ? cwi_outfolder_commit(&out->folder, err)
                         : cwi_outfile_commit(&out->file, err);
    if (st == CW_OK && d->sink)
        st = cwi_byte_output_deliver(&out->bytes, err);
    abort_output(out);
    return st;
}

static cw_status write_by_team(const char *path, const cwi_parts *parts,
                               const cwi_format_driver *f, const cw_team *team,
                               const cw_write_desc *d, const cw_write_consent *consent,
                               cwi_mesh_output *out, cw_error *err)
{
    cw_status consented = consent ? consent->ask(consent->user, err) : CW_OK;
    consented = cw_team_agree(team, consented, err);
    if (consented != CW_OK)
        return consented;
    if (f->write.shares && !d->text && !d->sink)
        return write_shared(path, parts, f, team, d, out, err);
    const bool writes = team->rank == 0;
    cw_status st = writes ? write_parts(path, parts, f, d, NULL, out, err) : CW_OK;
    return cw_team_agree(team, st, err);
}

/* Finds the team that shares a spool among the parts. Returns NULL if none does. */
static const cw_team *find_team(const cw_part *parts, size_t count)
{
    const cw_team *team = NULL;
    for (size_t i = 0; i < count; i++)
        team = parts[i].spool && parts[i].spool->team ? parts[i].spool->team : team;
    return team;
}

/* Returns the path of a file, or what stands for it where a sink takes the bytes. */
static const char *path_of(const char *path, const cw_write_desc *desc, const char *otherwise)
{
    return path || !desc || !desc->sink ? path : otherwise;
}

static const char memory_name[] = "(memory)", default_stem[] = "mesh";

cw_status cw_parts_write_with_consent(const char *path, const cw_part *parts, size_t count,
                                      const cw_write_desc *desc,
                                      const cw_write_consent *consent, cw_error *err)
{
    const char *shown = path_of(path, desc, memory_name);
    path = path_of(path, desc, default_stem);
    CWI_REQUIRE(err, path);
    CWI_REQUIRE_VERSION(err, desc, 0);
    CWI_REQUIRE_ARRAY(err, parts, count);
    cw_write_desc d = desc ? *desc : (cw_write_desc){0};
    const cwi_format_driver *f;
    char name[CWI_NAME_BYTES];
    double origin[3];
    cwi_parts placed = {0};
    cwi_choose_name(path, parts, count, &d, name);
    cwi_mesh_output out = {.path = path,
                           .name = name,
                           .local_origin = d.local ? origin : NULL,
                           .desc = &d,
                           .axes = &d.axes,
                           .text = d.text,
                           .progress = &d.progress};
    cw_status st = prepare_writer(path, &d, &f, err);
    if (st == CW_OK)
        st = check_levels(f, parts, count, err);
    if (st == CW_OK)
        st = check_spools(f, parts, count, &d, err);
    if (st == CW_OK && d.sides && count != 1)
        st = cwi_fail(err, CW_ERR_ARGUMENT,
                      "the sides of triangles are those of one mesh, not of %zu", count);
    if (st == CW_OK && f->write.own_axes)
        d.axes = (cw_axes){0};
    if (st == CW_OK && f->write.ras_mm)
        d.axes = (cw_axes){.unit = CW_UNIT_MM, .ras = true};
    if (st == CW_OK && f->write.only)
        d.compression = f->write.only;
    if (st == CW_OK)
        st = cwi_parts_place(parts, count, &d, keeps_of(f, &d), name, &placed, origin, err);
    const cw_team *team = find_team(parts, count);
    if (team)
        st = cw_team_agree(team, st, err);
    if (st == CW_OK)
        st = team ? write_by_team(path, &placed, f, team, &d, consent, &out, err)
                  : write_parts(path, &placed, f, &d, consent, &out, err);
    cwi_parts_free(&placed);
    return st == CW_OK ? CW_OK : cwi_fail_in(err, st, shown);
}

cw_status cw_parts_write(const char *path, const cw_part *parts, size_t count,
                         const cw_write_desc *desc, cw_error *err)
{
    CWI_REQUIRE_VERSION(err, desc, 0);
    return cw_parts_write_with_consent(path, parts, count, desc, NULL, err);
}

cw_status cw_mesh_write(const char *path, const cw_mesh *mesh, const cw_write_desc *desc,
                        cw_error *err)
{
    const char *shown = path_of(path, desc, memory_name);
    CWI_REQUIRE(err, shown, mesh);
    CWI_REQUIRE_VERSION(err, desc, 0);
    return cw_parts_write(path, &(cw_part){.mesh = mesh}, 1, desc, err);
}

/* Returns true for a local file of one part: it holds its positions as they are. */
static bool is_exact(const cwi_part *part, const cw_write_desc *d)
{
    const double *origin = part->mesh.origin;
    return d->local && origin[0] == 0 && origin[1] == 0 && origin[2] == 0;
}

static bool has_opacity(const uint8_t *colors, size_t count)
{
    for (size_t i = 0; colors && i < count; i++)
        if (colors[4 * i + 3] != 255)
            return true;
    return false;
}

/* Returns true if a vertex of parts as they are written is not opaque, or a face where they have a
 * rounded colour alone. */
static bool is_translucent(const cwi_parts *placed, const cwi_format_driver *f)
{
    for (size_t i = 0; i < placed->count; i++) {
        const cwi_part *p = &placed->items[i];
        if (has_opacity(p->mesh.colors, p->mesh.vertex_count) ||
            (f->write.color_bits && has_opacity(p->face_colors, p->mesh.triangle_count)))
            return true;
    }
    return false;
}

/* Counts the faces whose colour is not one of the levels that the format has. */
static size_t count_rounded(const cwi_parts *placed, int bits)
{
    const unsigned levels = (1u << bits) - 1;
    size_t count = 0;
    for (size_t i = 0; i < placed->count && bits; i++) {
        const cwi_part *p = &placed->items[i];
        for (size_t t = 0; p->face_colors && t < p->mesh.triangle_count; t++) {
            bool same = true;
            for (size_t c = 0; c < 3; c++) {
                const unsigned is = p->face_colors[4 * t + c],
                               level = (is * levels + 127) / 255;
                same = same && (level * 255 + levels / 2) / levels == is;
            }
            count += !same;
        }
    }
    return count;
}

/* Returns the flags of what textures hold. */
static unsigned pictures_of(const cw_textures *set)
{
    if (!set)
        return 0;
    return (set->color.bytes || set->normal.bytes || set->emissive.bytes ? CW_KEEPS_PICTURES
                                                                         : 0u) |
           (set->metallic_roughness.bytes || set->occlusion.bytes ? CW_KEEPS_MATERIALS : 0u);
}

static unsigned find_dropped(const cw_part *parts, size_t count, const cwi_parts *placed,
                             const cwi_format_driver *f, const cw_write_loss *loss)
{
    const unsigned keeps = f->keeps;
    unsigned had = CW_KEEPS_SHARING | (placed->count > 1 ? CW_KEEPS_PARTS : 0u);
    unsigned has = keeps & (CW_KEEPS_SHARING | CW_KEEPS_PARTS | CW_KEEPS_AFFINE);
    for (size_t i = 0; i < count; i++)
        had |= pictures_of(parts[i].textures);
    for (size_t i = 0; i < placed->count; i++)
        has |=
            placed->items[i].textures ? keeps & (CW_KEEPS_PICTURES | CW_KEEPS_MATERIALS) : 0u;
    for (size_t i = 0; i < count; i++)
        had |= parts[i].spool ? cwi_spool_arrays(parts[i].spool) : cwi_arrays_of(parts[i].mesh);
    for (size_t i = 0; i < placed->count; i++) {
        const bool hidden = f->write.one_coloring && placed->items[i].face_colors;
        has |= placed->items[i].arrays &
               ~(unsigned)(CW_KEEPS_AFFINE | (hidden ? CW_KEEPS_COLORS : 0));
    }
    if (!(keeps & CW_KEEPS_OPACITY) && is_translucent(placed, f))
        had |= CW_KEEPS_OPACITY;
    if (loss->merged_vertices || loss->flat_triangles)
        had |= CW_KEEPS_PLACES;
    return had & ~has;
}

/* Prints the names of the attributes of all parts, each once: "uv, thickness". */
static void name_attributes(const cw_part *parts, size_t count, char *text, size_t size)
{
    size_t used = 0;
    for (size_t i = 0; i < count; i++)
        for (size_t n = 0; parts[i].mesh && n < parts[i].mesh->attribute_count; n++) {
            const char *name = parts[i].mesh->attributes[n].name;
            size_t first = 0;
            if (strcmp(name, CW_FACE_COLORS) == 0 || strcmp(name, CW_CORNER_NORMALS) == 0)
                continue;
            while (!parts[first].mesh || !cw_mesh_attribute_find(parts[first].mesh, name))
                first++;
            if (first == i && used < size)
                used +=
                    (size_t)snprintf(text + used, size - used, "%s%s", used ? ", " : "", name);
        }
}

cw_status cw_parts_write_loss(const char *path, const cw_part *parts, size_t count,
                              const cw_write_desc *desc, cw_write_loss *loss, cw_error *err)
{
    path = path_of(path, desc, memory_name);
    CWI_REQUIRE(err, path, loss);
    CWI_REQUIRE_VERSION(err, desc, 0);
    CWI_REQUIRE_ARRAY(err, parts, count);
    const cw_write_desc d = desc ? *desc : (cw_write_desc){0};
    const cwi_format_driver *f;
    double origin[3];
    cwi_parts placed = {0};
    memset(loss, 0, sizeof *loss);
    cw_status st = prepare_writer(path, &d, &f, err);
    if (st == CW_OK)
        st = cwi_parts_place(parts, count, &d, keeps_of(f, &d), "", &placed, origin, err);
    for (size_t i = 0; i < placed.count && st == CW_OK; i++)
        if (!(f->keeps & CW_KEEPS_PLACES) && !is_exact(&placed.items[i], &d))
            st = cwi_measure_loss(&placed.items[i], loss, err);
    if (st == CW_OK)
        loss->rounded_colors = count_rounded(&placed, f->write.color_bits);
    if (st == CW_OK && f->write.count_split)
        st = f->write.count_split(&placed, &d, &loss->split_vertices, err);
    if (st == CW_OK)
        loss->dropped = find_dropped(parts, count, &placed, f, loss);
    if (st == CW_OK && loss->dropped & CW_KEEPS_ATTRIBUTES)
        name_attributes(parts, count, loss->attributes, sizeof loss->attributes);
    cwi_parts_free(&placed);
    return st == CW_OK ? CW_OK : cwi_fail_in(err, st, path);
}

cw_status cw_mesh_write_loss(const char *path, const cw_mesh *mesh, const cw_write_desc *desc,
                             cw_write_loss *loss, cw_error *err)
{
    path = path_of(path, desc, memory_name);
    CWI_REQUIRE(err, path, mesh, loss);
    CWI_REQUIRE_VERSION(err, desc, 0);
    return cw_parts_write_loss(path, &(cw_part){.mesh = mesh}, 1, desc, loss, err);
}

cw_status cw_mesh_write_check(const char *path, const cw_write_desc *desc, cw_error *err)
{
    path = path_of(path, desc, memory_name);
    CWI_REQUIRE(err, path);
    CWI_REQUIRE_VERSION(err, desc, 0);
    const cw_write_desc d = desc ? *desc : (cw_write_desc){0};
    cwi_mesh_output out = {0};
    const cwi_format_driver *f;
    cw_status st = prepare_writer(path, &d, &f, err);
    if (st == CW_OK) /* the only sure way is to make a file and drop it */
        st = open_output(path, f, &d, &out, err);
    abort_output(&out);
    return st == CW_OK ? CW_OK : cwi_fail_in(err, st, path);
}
