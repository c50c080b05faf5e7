/* Opens the nodes of a Zarr store, and lists those below a group. */
#define _GNU_SOURCE /* O_PATH, DT_DIR */
#include "formats/zarr/zarr_dialect.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/bytes/file_pattern.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { MAX_DEPTH = 8, MAX_FOLDERS = 4096 };

static const cwi_zarr_words array_words_v2 = {.file = ".zarray",
                                              .attributes = ".zattrs",
                                              .type = "dtype",
                                              .shape = "shape",
                                              .frame = "coordinateTransformations"},
                            group_words_v2 = {.file = ".zgroup", .attributes = ".zattrs"},
                            words_v3 = {.file = "zarr.json",
                                        .attributes = "zarr.json",
                                        .type = "data_type",
                                        .shape = "shape",
                                        .frame = "coordinateTransformations"};

cw_status cwi_zarr_join(const char *path, const char *name, char joined[CWI_ZARR_KEY_BYTES],
                        cw_error *err)
{
    if (strcmp(name, ".") == 0)
        name = "";
    const int length =
        snprintf(joined, CWI_ZARR_KEY_BYTES, "%s%s%s", path, *path && *name ? "/" : "", name);
    return length < CWI_ZARR_KEY_BYTES / 2
               ? CW_OK
               : cwi_fail(err, CW_ERR_LIMIT,
                          "a path below the store has %d bytes; at most %d "
                          "are read",
                          length, CWI_ZARR_KEY_BYTES / 2);
}

cw_status cwi_zarr_node_json(const cwi_zarr_node *node, const cwi_input *in, const char *name,
                             cwi_zarr_json *json, cw_error *err)
{
    char path[CWI_ZARR_KEY_BYTES];
    cw_status st = cwi_zarr_join(node->path, name, path, err);
    return st == CW_OK ? cwi_zarr_json_open(json, in, path, err) : st;
}

static cw_status read_node_type(cwi_zarr_node *node, cw_error *err)
{
    const char *type = cwi_zarr_text(node->meta.root, "node_type");
    node->words = &words_v3;
    node->attrs = json_object_get(node->meta.root, "attributes");
    if (type && strcmp(type, "array") == 0)
        node->kind = CWI_ZARR_IS_ARRAY;
    else if (type && strcmp(type, "group") == 0)
        node->kind = CWI_ZARR_IS_GROUP;
    else
        return cwi_zarr_fail_in(
            err, cwi_zarr_fail(err, node->meta.root, "node_type", "\"array\" or \"group\""),
            node, false);
    return CW_OK;
}

static cw_status open_v2(cwi_zarr_node *node, const cwi_input *in, cw_error *err)
{
    node->words = &array_words_v2;
    cw_status st = cwi_zarr_node_json(node, in, ".zarray", &node->meta, err);
    node->kind = node->meta.root ? CWI_ZARR_IS_ARRAY : CWI_ZARR_NOTHING;
    if (st == CW_OK && !node->meta.root) {
        st = cwi_zarr_node_json(node, in, ".zgroup", &node->meta, err);
        node->kind = node->meta.root ? CWI_ZARR_IS_GROUP : CWI_ZARR_NOTHING;
        node->words = &group_words_v2;
    }
    if (st == CW_OK && node->kind != CWI_ZARR_NOTHING)
        st = cwi_zarr_node_json(node, in, ".zattrs", &node->attributes, err);
    node->attrs = node->attributes.root;
    return st;
}

cw_status cwi_zarr_node_open(cwi_zarr_node *node, const cwi_input *in, const char *path,
                             cw_error *err)
{
    *node = (cwi_zarr_node){0};
    cw_status st = cwi_zarr_join("", path, node->path, err);
    if (st == CW_OK)
        st = cwi_zarr_node_json(node, in, "zarr.json", &node->meta, err);
    if (st == CW_OK && node->meta.root)
        st = read_node_type(node, err);
    else if (st == CW_OK)
        st = open_v2(node, in, err);
    const json_t *ome = json_object_get(node->attrs, "ome");
    node->ome = ome ? ome : node->attrs;
    return st;
}

void cwi_zarr_node_close(cwi_zarr_node *node)
{
    cwi_zarr_json_close(&node->meta);
    cwi_zarr_json_close(&node->attributes);
    *node = (cwi_zarr_node){0};
}

cw_status cwi_zarr_fail_in(cw_error *err, cw_status status, const cwi_zarr_node *node,
                           bool in_attributes)
{
    const cwi_zarr_words *words = node->words;
    char path[CWI_ZARR_KEY_BYTES];
    if (cwi_zarr_join(words->at_root ? "" : node->path,
                      in_attributes ? words->attributes : words->file, path, NULL) != CW_OK)
        return status;
    return cwi_fail_in(err, status, path);
}

cw_status cwi_zarr_parse(const cwi_zarr_node *node, cwi_zarr_array *array, cw_error *err)
{
    return node->words == &words_v3
               ? cwi_zarr_parse_v3(node->meta.root, array, err)
               : cwi_zarr_parse_v2(node->meta.root, node->attrs, array, err);
}

cw_status cwi_zarr_node_array(const cwi_zarr_dialect *dialect, const cwi_zarr_node *node,
                              cwi_zarr_array *array, cw_error *err)
{
    *array = (cwi_zarr_array){.words = node->words};
    snprintf(array->path, sizeof array->path, "%s", node->path);
    cw_status st = dialect->parse_array(node, array, err);
    return st == CW_OK ? CW_OK : cwi_zarr_fail_in(err, st, node, false);
}

/* --- listing ------------------------------------------------------------------------------ */

/* Returns true if an entry is a folder that may be entered. */
static bool is_open_folder(int folder, const char *name, bool follow)
{
    struct stat info;
    return name[0] != '.' &&
           fstatat(folder, name, &info, follow ? 0 : AT_SYMLINK_NOFOLLOW) == 0 &&
           S_ISDIR(info.st_mode);
}

/* Adds the names of the folders in a folder. */
static cw_status list_folders(const cwi_input *in, const char *path, cwi_names *names,
                              cw_error *err)
{
    const int flags = O_RDONLY | O_DIRECTORY | O_CLOEXEC;
    const int fd =
        openat(in->folder, *path ? path : ".", flags | (in->allow_external ? 0 : O_NOFOLLOW));
    DIR *folder = fd < 0 ? NULL : fdopendir(fd);
    cw_status st = CW_OK;
    if (!folder) {
        if (fd >= 0)
            close(fd);
        return cwi_fail(err, CW_ERR_IO, "the folder '%s' cannot be listed", path);
    }
    for (const struct dirent *entry; st == CW_OK && (entry = readdir(folder));)
        if (is_open_folder(fd, entry->d_name, in->allow_external)) {
            st = names->count < MAX_FOLDERS
                     ? cwi_names_add(names, entry->d_name, err)
                     : cwi_fail(err, CW_ERR_LIMIT, "a group has more than %d folders",
                                MAX_FOLDERS);
        }
    closedir(folder);
    cwi_files_sort(names);
    return st;
}

static cw_status list_below(const cwi_zarr_dialect *dialect, const cwi_input *in,
                            const char *path, int depth, cwi_zarr_listing *list, cw_error *err)
{
    cwi_names names = {0};
    cw_status st = depth < MAX_DEPTH ? list_folders(in, path, &names, err) : CW_OK;
    for (size_t n = 0; st == CW_OK && n < names.count; n++) {
        char child[CWI_ZARR_KEY_BYTES];
        cwi_zarr_node node = {0};
        if (++list->visited > MAX_FOLDERS) {
            st = cwi_fail(err, CW_ERR_LIMIT, "the store has more than %d folders", MAX_FOLDERS);
            break;
        }
        st = cwi_zarr_join(path, names.items[n], child, err);
        if (st == CW_OK)
            st = dialect->open_node(&node, in, child, err);
        if (st == CW_OK && (node.kind == CWI_ZARR_IS_ARRAY || dialect->is_image(&node)))
            st = cwi_names_add(&list->paths, child, err);
        else if (st == CW_OK && node.kind == CWI_ZARR_IS_GROUP)
            st = list_below(dialect, in, child, depth + 1, list, err);
        cwi_zarr_node_close(&node);
    }
    cwi_names_free(&names);
    return st;
}

cw_status cwi_zarr_list(const cwi_zarr_dialect *dialect, const cwi_input *in, const char *path,
                        cwi_zarr_listing *list, cw_error *err)
{
    *list = (cwi_zarr_listing){0};
    return list_below(dialect, in, path, 0, list, err);
}
