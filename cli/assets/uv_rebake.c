/* Carries pictures of a textured mesh over to another texture. */
#include "cli/assets/uv_rebake.h"

#include "cli/framework/console.h"
#include "core/base/memory.h"
#include "core/base/status.h"

#include <stdlib.h>
#include <string.h>

static const char *const uses[CW_PICTURE_USES] = {"colour", "normal", "metallic-roughness",
                                                  "occlusion", "emissive"};

/* Decoded pictures of all parts; parts may share one. */
typedef struct decoded {
    cw_bake_source *sources;
    cw_image *images; /* CW_PICTURE_USES for each part */
} decoded;

static const cw_texture *picture_of(const cw_textures *set, int use)
{
    const cw_texture *const pictures[CW_PICTURE_USES] = {
        &set->color, &set->normal, &set->metallic_roughness, &set->occlusion, &set->emissive};
    return pictures[use];
}

cw_status cli_rebake_read(const char *path, const cli_input *input, cli_rebake *r,
                          cw_error *err)
{
    bool has_pictures = false;
    cw_status st = cli_read_parts(path, NULL, input, &r->old, err);
    for (size_t p = 0; st == CW_OK && p < r->old.part_count; p++)
        has_pictures = has_pictures || r->old.parts[p].textures;
    return st == CW_OK && !has_pictures
               ? cwi_fail(err, CW_ERR_ARGUMENT, "--rebake %s: it has no pictures", path)
               : st;
}

/* Decodes the picture of a part, unless an earlier part has the same. */
static cw_status decode_picture(const cli_rebake *r, decoded *d, size_t part, int use,
                                cw_error *err)
{
    const cw_textures *set = r->old.parts[part].textures;
    const cw_texture *file = set ? picture_of(set, use) : NULL;
    if (!file || !file->bytes)
        return CW_OK;
    for (size_t p = 0; p < part; p++) {
        const cw_textures *other = r->old.parts[p].textures;
        if (other && picture_of(other, use)->bytes == file->bytes) {
            d->sources[part].pictures[use] = d->sources[p].pictures[use];
            return CW_OK;
        }
    }
    cw_image *image = &d->images[part * CW_PICTURE_USES + (size_t)use];
    cw_error why = {0};
    const cw_status st = cw_image_decode(file->bytes, file->size, image, &why);
    if (st == CW_OK)
        d->sources[part].pictures[use] = image;
    else if (st == CW_ERR_NO_MEMORY)
        return cwi_fail(err, st, "%s", why.message);
    else
        cli_say("%s: %s picture left out, as it cannot be decoded: %s", r->old.path, uses[use],
                why.message);
    return CW_OK;
}

static cw_status decode_pictures(const cli_rebake *r, decoded *d, cw_error *err)
{
    const size_t count = r->old.part_count;
    cw_status st = CW_OK;
    d->sources = calloc(count, sizeof *d->sources);
    d->images = calloc(count * CW_PICTURE_USES, sizeof *d->images);
    if (!d->sources || !d->images)
        return cwi_fail_memory(err);
    for (size_t p = 0; p < count && st == CW_OK; p++) {
        const cw_part *part = &r->old.parts[p];
        d->sources[p].mesh = part->mesh;
        d->sources[p].repeats = part->textures && part->textures->repeats;
        for (int use = 0; use < CW_PICTURE_USES && st == CW_OK; use++)
            st = decode_picture(r, d, p, use, err);
    }
    return st;
}

static void free_decoded(decoded *d, size_t parts)
{
    for (size_t n = 0; d->images && n < parts * CW_PICTURE_USES; n++)
        cw_image_free(&d->images[n]);
    free(d->images);
    free(d->sources);
}

/* Puts baked pictures as PNG among the textures, with the factors of the first part that has any. */
static cw_status encode_pictures(cli_rebake *r, const cw_image *baked, cw_textures *textures,
                                 cw_error *err)
{
    cw_status st = CW_OK;
    for (size_t p = 0; p < r->old.part_count; p++) {
        const cw_textures *set = r->old.parts[p].textures;
        if (!set || textures->has_factors)
            continue;
        const cw_texture normal = textures->normal;
        *textures = *set;
        textures->repeats = false;
        for (int use = 0; use < CW_PICTURE_USES; use++)
            *(cw_texture *)(uintptr_t)picture_of(textures, use) = (cw_texture){0};
        textures->normal = normal;
    }
    for (int use = 0; use < CW_PICTURE_USES && st == CW_OK; use++) {
        cw_texture *to = (cw_texture *)(uintptr_t)picture_of(textures, use);
        if (!baked[use].pixels || (use == CW_PICTURE_NORMAL && to->bytes)) /* --bake made one */
            continue;
        st = cw_image_encode(&baked[use], use == CW_PICTURE_COLOR || use == CW_PICTURE_EMISSIVE,
                             &r->png[use], &to->size, err);
        to->bytes = r->png[use];
    }
    return st;
}

cw_status cli_rebake_run(cli_rebake *r, const cw_mesh *mesh, const cw_bake_desc *desc,
                         cw_textures *textures, cw_error *err)
{
    decoded d = {0};
    cw_image baked[CW_PICTURE_USES] = {{0}};
    cw_status st = decode_pictures(r, &d, err);
    if (st == CW_OK)
        st = cw_bake_pictures(mesh, d.sources, r->old.part_count, desc, baked, &r->facts, err);
    if (st == CW_OK)
        st = encode_pictures(r, baked, textures, err);
    for (int use = 0; use < CW_PICTURE_USES; use++)
        cw_image_free(&baked[use]);
    free_decoded(&d, r->old.part_count);
    return st;
}

void cli_rebake_free(cli_rebake *r)
{
    for (int use = 0; use < CW_PICTURE_USES; use++)
        cw_bytes_free(r->png[use]);
    cli_free_mesh(&r->old);
}
