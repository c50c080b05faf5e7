/* Opens an array of a store: finds it by path, name or level, and makes its caches. */
#include "formats/zarr/zarr.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/thread_pool.h"
#include "core/volume/label_ids.h"
#include "formats/bytes/file_pattern.h"
#include "formats/volume/named_arrays.h"
#include "formats/zarr/zarr_dialect.h"

#include <stdio.h>
#include <string.h>

enum { CACHE_BYTES = 256 << 20, MAX_SLOTS = 1 << 18 };

/* Folders above a level's in which its image is looked for. */
enum { MAX_ABOVE = 3 };

/* --- from nodes to arrays ----------------------------------------------------------------- */

/* Takes the array of a node by itself. */
static cw_status take_array(cwi_zarr *z, const cwi_zarr_node *node, cw_error *err)
{
    cwi_zarr_frame frame;
    cw_status st = cwi_zarr_node_array(z->dialect, node, &z->array, err);
    if (st != CW_OK)
        return st;
    st = z->dialect->array_frame(node, &z->array, &frame, err);
    if (st == CW_OK)
        st = cwi_zarr_set_frame(z, &frame, err);
    return st == CW_OK ? CW_OK : cwi_zarr_fail_in(err, st, node, false);
}

/* Opens the array of a level, and its node, which the caller closes in any case. */
static cw_status open_level(const cwi_zarr *z, const cwi_zarr_node *image, size_t level,
                            cwi_zarr_node *node, cwi_zarr_array *array, cw_error *err)
{
    char path[CWI_ZARR_KEY_BYTES];
    *node = (cwi_zarr_node){0};
    cw_status st = z->dialect->level_path(image, level, path, err);
    if (st == CW_OK)
        st = z->dialect->open_node(node, &z->in, path, err);
    if (st == CW_OK && node->kind != CWI_ZARR_IS_ARRAY) {
        st = cwi_fail(err, CW_ERR_FORMAT, "level %zu is '%.200s', where no array is", level,
                      path);
        cwi_zarr_fail_in(err, st, image, true);
    }
    return st == CW_OK ? cwi_zarr_node_array(z->dialect, node, array, err) : st;
}

static cw_status take_image(cwi_zarr *z, const cwi_zarr_node *image, size_t level,
                            cwi_zarr_found *found, cw_error *err)
{
    cwi_zarr_frame frame;
    cwi_zarr_node node;
    const size_t count = z->dialect->level_count(image);
    if (count == 0)
        return cwi_zarr_fail_in(
            err, cwi_fail(err, CW_ERR_FORMAT, "'multiscales' has no 'datasets'"), image, true);
    if (level >= count)
        return cwi_fail(err, CW_ERR_ARGUMENT, "level %zu was asked for; there are %zu, from 0",
                        level, count);
    cw_status st = open_level(z, image, level, &node, &z->array, err);
    if (st == CW_OK && z->dialect->read_facts)
        st = z->dialect->read_facts(z, image, found, err);
    if (st == CW_OK)
        st = z->dialect->level_frame(image, level, &node, &z->array, &frame, err);
    if (st == CW_OK && (st = cwi_zarr_set_frame(z, &frame, err)) != CW_OK)
        cwi_zarr_fail_in(err, st, image, true);
    z->level_count = count;
    cwi_zarr_node_close(&node);
    return st;
}

static cw_status take_node(cwi_zarr *z, const cwi_zarr_node *node, size_t level,
                           cwi_zarr_found *found, cw_error *err)
{
    if (z->dialect->is_image(node))
        return take_image(z, node, level, found, err);
    if (level > 0)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "level %zu was asked for; the array '%s' has no levels", level,
                        *node->path ? node->path : ".");
    return take_array(z, node, err);
}

/* Finds the level of an image that a name is the path of. */
static bool find_named_level(const cwi_zarr *z, const cwi_zarr_node *root, const char *name,
                             size_t *level)
{
    char path[CWI_ZARR_KEY_BYTES];
    const size_t count = z->dialect->is_image(root) ? z->dialect->level_count(root) : 0;
    for (size_t n = 0; n < count; n++)
        if (z->dialect->level_path(root, n, path, NULL) == CW_OK && strcmp(path, name) == 0) {
            *level = n;
            return true;
        }
    return false;
}

/* Looks for an image above the array that a name leads to, which has it as a level, from the nearest group on. The node
 * is left open if there is one. */
static cw_status find_image_above(const cwi_zarr *z, const char *name, cwi_zarr_node *image,
                                  size_t *level, cw_error *err)
{
    char path[CWI_ZARR_KEY_BYTES];
    snprintf(path, sizeof path, "%s", name);
    while (*path) {
        char *slash = strrchr(path, '/');
        *(slash ? slash : path) = '\0';
        const cw_status st = z->dialect->open_node(image, &z->in, path, err);
        if (st != CW_OK || find_named_level(z, image, name, level))
            return st;
        cwi_zarr_node_close(image);
    }
    return CW_OK;
}

/* Takes the array as a level of the image above it that lists it. is_taken: false where none does */
static cw_status take_level(cwi_zarr *z, const char *name, cwi_zarr_found *found,
                            bool *is_taken, cw_error *err)
{
    cwi_zarr_node image = {0};
    size_t level = 0;
    cw_status st = find_image_above(z, name, &image, &level, err);
    *is_taken = st == CW_OK && z->dialect->is_image(&image);
    if (*is_taken) {
        st = take_image(z, &image, level, found, err);
        z->level_count = 0; /* one was named */
    }
    cwi_zarr_node_close(&image);
    return st;
}

/* --- groups ------------------------------------------------------------------------------- */

/* Looks at an array or image of a group. An array that is not read has 0 dimensions. */
static cw_status look_at(const cwi_zarr *z, const char *path, cwi_zarr_array *array,
                         cw_error *err)
{
    cwi_zarr_node node = {0}, level = {0};
    cw_error ignored;
    *array = (cwi_zarr_array){0};
    cw_status st = z->dialect->open_node(&node, &z->in, path, err);
    if (st == CW_OK) {
        st = z->dialect->is_image(&node)
                 ? open_level(z, &node, 0, &level, array, &ignored)
                 : cwi_zarr_node_array(z->dialect, &node, array, &ignored);
        if (st == CW_ERR_NO_MEMORY) {
            cwi_fail(err, st, "%s", ignored.message);
        } else if (st != CW_OK) {
            array->rank = 0;
            st = CW_OK;
        }
    }
    cwi_zarr_node_close(&level);
    cwi_zarr_node_close(&node);
    return st;
}

/* Finds the first array of a group with three dimensions or more, else its first that is read. */
static cw_status choose_array(cwi_zarr *z, const cwi_zarr_node *group, cwi_zarr_found *found,
                              char chosen[CWI_ZARR_KEY_BYTES], cw_error *err)
{
    cwi_zarr_listing list;
    size_t best = 0;
    cw_status st = cwi_zarr_list(z->dialect, &z->in, group->path, &list, err);
    chosen[0] = '\0';
    for (size_t n = 0; st == CW_OK && n < list.paths.count; n++) {
        cwi_zarr_array array;
        st = look_at(z, list.paths.items[n], &array, err);
        const size_t worth = array.rank > 3 ? 3 : array.rank;
        if (st == CW_OK && found->arrays)
            cwi_array_list_add(found->arrays, list.paths.items[n], array.type_name, 1, false,
                               array.rank > 0);
        if (worth > best && (worth == 3 || best == 0)) {
            best = worth;
            snprintf(chosen, CWI_ZARR_KEY_BYTES, "%s", list.paths.items[n]);
        }
    }
    if (st == CW_OK && !chosen[0])
        st = list.paths.count ? look_at(z, list.paths.items[0], &z->array, err)
                              : cwi_fail(err, CW_ERR_FORMAT, "the group holds no array");
    if (st == CW_OK && !chosen[0])
        snprintf(chosen, CWI_ZARR_KEY_BYTES, "%s", list.paths.items[0]); /* it tells why not */
    if (st == CW_OK && found->arrays)
        cwi_array_list_choose(found->arrays, chosen, false);
    cwi_names_free(&list.paths);
    return st;
}

static cw_status take_group(cwi_zarr *z, const cwi_zarr_node *group, size_t level,
                            cwi_zarr_found *found, cw_error *err)
{
    cwi_zarr_node node = {0};
    char path[CWI_ZARR_KEY_BYTES];
    bool is_taken = false;
    cw_status st = choose_array(z, group, found, path, err);
    if (st == CW_OK && !level)
        st = take_level(z, path, found, &is_taken, err);
    if (st != CW_OK || is_taken)
        return st;
    st = z->dialect->open_node(&node, &z->in, path, err);
    if (st == CW_OK)
        st = take_node(z, &node, level, found, err);
    cwi_zarr_node_close(&node);
    return st;
}

/* Reports a name that leads to nothing, with as many of the store's arrays as fit. */
static cw_status fail_name(const cwi_zarr *z, const char *name, cw_error *err)
{
    cwi_zarr_listing list;
    char text[240] = "";
    size_t used = 0, n = 0;
    cw_status st = cwi_zarr_list(z->dialect, &z->in, "", &list, err);
    for (; st == CW_OK && n < list.paths.count && used < sizeof text - 80; n++)
        used += (size_t)snprintf(text + used, sizeof text - used, "%s'%.60s'",
                                 used ? ", " : "; there are ", list.paths.items[n]);
    if (st == CW_OK)
        st = cwi_fail(err, CW_ERR_ARGUMENT, "the store has no array '%.200s'%s%s", name, text,
                      n < list.paths.count ? ", ..." : "");
    cwi_names_free(&list.paths);
    return st;
}

/* Takes the node that a name leads to, from the root. */
static cw_status take_named(cwi_zarr *z, const cwi_zarr_desc *desc, cwi_zarr_found *found,
                            cw_error *err)
{
    cwi_zarr_node node = {0};
    const size_t level = desc->level;
    bool is_taken;
    cw_status st = take_level(z, desc->array, found, &is_taken, err);
    if (st != CW_OK || is_taken)
        return st;
    st = z->dialect->open_node(&node, &z->in, desc->array, err);
    if (st == CW_OK && node.kind == CWI_ZARR_NOTHING)
        st = fail_name(z, desc->array, err);
    else if (st == CW_OK && node.kind == CWI_ZARR_IS_GROUP && !z->dialect->is_image(&node))
        st = take_group(z, &node, level, found, err);
    else if (st == CW_OK)
        st = take_node(z, &node, level, found, err);
    cwi_zarr_node_close(&node);
    return st;
}

/* Opens the folder above a level's, if it is an image that lists the level; else the level's, whose name is then empty.
 * name  set to the level's path in the folder */
static cw_status open_folder_above(cwi_zarr *z, const char *path, char name[CWI_ZARR_KEY_BYTES],
                                   cw_error *err)
{
    char *above = cwi_strdup(path);
    size_t end = strlen(path), level;
    bool is_found = false;
    cw_status st = above ? CW_OK : cwi_fail_memory(err);
    while (st == CW_OK && end > 1 && above[end - 1] == '/')
        above[--end] = '\0';
    const size_t whole = end;
    for (int n = 0; st == CW_OK && n < MAX_ABOVE && !is_found && end; n++) {
        cwi_zarr_node image = {0};
        cwi_input in = {0};
        cw_error ignored;
        while (end && above[end - 1] != '/')
            end--;
        if (whole - end >= CWI_ZARR_KEY_BYTES)
            break;
        snprintf(name, CWI_ZARR_KEY_BYTES, "%.*s", (int)(whole - end), path + end);
        above[end > 1 ? end - 1 : end] = '\0';
        if (cwi_input_open_folder(&in, *above ? above : ".", &ignored) == CW_OK &&
            z->dialect->open_node(&image, &in, "", &ignored) == CW_OK)
            is_found = find_named_level(z, &image, name, &level);
        cwi_zarr_node_close(&image);
        cwi_input_close(&in);
        end -= end > 0;
    }
    if (is_found) {
        const bool allow_external = z->in.allow_external;
        cwi_input_close(&z->in);
        st = cwi_input_open_folder(&z->in, *above ? above : ".", err);
        z->in.allow_external = allow_external;
    } else {
        *name = '\0';
    }
    cwi_free(above);
    return st;
}

/* Takes an array that is the store itself: as a level of the image above its folder, if one lists it. */
static cw_status take_lone_array(cwi_zarr *z, const cwi_zarr_node *root, size_t level,
                                 cwi_zarr_found *found, cw_error *err)
{
    char name[CWI_ZARR_KEY_BYTES] = "";
    bool is_taken = false;
    cw_status st =
        !level && cwi_is_folder(z->path) ? open_folder_above(z, z->path, name, err) : CW_OK;
    if (st == CW_OK && *name)
        st = take_level(z, name, found, &is_taken, err);
    return st != CW_OK || is_taken ? st : take_node(z, root, level, found, err);
}

static cw_status take_root(cwi_zarr *z, const cwi_zarr_desc *desc, cwi_zarr_found *found,
                           cw_error *err)
{
    cwi_zarr_node root = {0};
    cw_status st = z->dialect->open_node(&root, &z->in, "", err);
    if (st == CW_OK && root.kind == CWI_ZARR_NOTHING && !desc->array)
        st = cwi_fail(err, CW_ERR_FORMAT, "the folder has no metadata of %s; %s was expected",
                      z->dialect->noun, z->dialect->expected);
    else if (st == CW_OK && desc->array)
        st = take_named(z, desc, found, err);
    else if (st == CW_OK && root.kind == CWI_ZARR_IS_GROUP && !z->dialect->is_image(&root))
        st = take_group(z, &root, desc->level, found, err);
    else if (st == CW_OK && root.kind == CWI_ZARR_IS_ARRAY)
        st = take_lone_array(z, &root, desc->level, found, err);
    else if (st == CW_OK)
        st = take_node(z, &root, desc->level, found, err);
    cwi_zarr_node_close(&root);
    return st;
}

/* --- the handle --------------------------------------------------------------------------- */

/* Opens the folder of a path, which may name a metadata file in it. */
static cw_status open_store(cwi_zarr *z, const char *path, cw_error *err)
{
    char name[CWI_ZARR_NAME_BYTES];
    z->path = cwi_strdup(path);
    if (!z->path)
        return cwi_fail_memory(err);
    if (cwi_is_folder(path))
        return cwi_input_open_folder(&z->in, z->path, err);
    cw_status st = cwi_input_open(&z->in, z->path, err);
    for (const char *next = z->dialect->files; st == CW_OK && *next;) {
        const size_t length = strcspn(next, " ");
        snprintf(name, sizeof name, "%.*s", (int)length, next);
        if (cwi_input_is_named(&z->in, name))
            return CW_OK;
        next += length + (next[length] == ' ');
    }
    return st == CW_OK ? cwi_fail(err, CW_ERR_FORMAT,
                                  "the folder of a %s store was expected, or %s in it",
                                  z->dialect->noun, z->dialect->expected)
                       : st;
}

/* Makes room for the chunks that are kept: two rows of one place in z each, as a slab with a plane
 * of the next one meets both. More would hold rows that slabs have passed. */
static cw_status make_caches(cwi_zarr *z, size_t bytes, cw_error *err)
{
    size_t slots = bytes / z->array.chunk_bytes, needed = 2;
    for (size_t d = 0; d < z->array.rank; d++)
        if ((int)d != z->dimensions[CWI_AXIS_Z] &&
            !cwi_size_mul(needed, (z->array.shape[d] - 1) / z->array.inner[d] + 1, &needed))
            needed = SIZE_MAX;
    slots = slots < needed ? slots : needed;
    z->slot_count = slots < MAX_SLOTS ? slots : MAX_SLOTS;
    z->slots = cwi_alloc_zeroed(z->slot_count, sizeof *z->slots);
    const size_t threads = (size_t)cwi_threads(z->threads);
    const size_t index_bytes = z->array.is_sharded ? 16 * z->array.shard_count : 1;
    const size_t indices = CWI_ZARR_INDEX_BYTES / index_bytes;
    z->shard_slots = (indices < CWI_ZARR_SHARDS ? indices : CWI_ZARR_SHARDS) + threads;
    z->spare = cwi_alloc_zeroed(z->slot_count, sizeof *z->spare);
    return z->slots && z->spare ? CW_OK : cwi_fail_memory(err);
}

cw_status cwi_zarr_open_found(const char *path, const cwi_zarr_desc *desc,
                              cwi_zarr_found *found, cwi_zarr **zarr, cw_error *err)
{
    cwi_zarr *z = cwi_alloc_zeroed(1, sizeof *z);
    *zarr = NULL;
    if (!z)
        return cwi_fail_memory(err);
    pthread_mutex_init(&z->lock, NULL);
    z->threads = desc->threads;
    z->dialect = desc->dialect ? desc->dialect : &cwi_dialect_zarr;
    cw_status st = open_store(z, path, err);
    z->in.allow_external = desc->allow_external;
    if (st == CW_OK)
        st = take_root(z, desc, found, err);
    if (st == CW_OK && z->dialect->prepare)
        st = z->dialect->prepare(z, err);
    if (st == CW_OK)
        st = make_caches(z, desc->cache_bytes ? desc->cache_bytes : CACHE_BYTES, err);
    if (st == CW_OK)
        *zarr = z;
    else
        cwi_zarr_close(z);
    return st;
}

cw_status cwi_zarr_open(const char *path, const cwi_zarr_desc *desc, cwi_zarr **zarr,
                        cw_error *err)
{
    static const cwi_zarr_desc defaults = {0};
    cwi_zarr_found found = {0};
    return cwi_zarr_open_found(path, desc ? desc : &defaults, &found, zarr, err);
}

void cwi_zarr_close(cwi_zarr *z)
{
    if (!z)
        return;
    for (size_t n = 0; n < z->slot_count && z->slots; n++)
        cwi_free(z->slots[n].bytes);
    for (size_t n = 0; n < z->spare_count; n++)
        cwi_free(z->spare[n]);
    cwi_free(z->slots);
    cwi_free(z->spare);
    cwi_zarr_close_shards(z);
    cwi_input_close(&z->in);
    pthread_mutex_destroy(&z->lock);
    cwi_free(z->extra);
    cwi_free(z->path);
    cwi_free(z);
}

void cwi_zarr_keep_wide(cwi_zarr *zarr)
{
    cwi_zarr_array *a = &zarr->array;
    if (a->stored != CWI_STORED_I64 && a->stored != CWI_STORED_U64)
        return;
    a->type = zarr->shape.type = (cw_type)(a->stored == CWI_STORED_I64 ? CWI_I64 : CWI_U64);
    a->stored = CWI_STORED_PLAIN;
}
