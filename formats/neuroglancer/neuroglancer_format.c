/* The driver of Neuroglancer's multi-resolution meshes: their writer, the requests that they have
 * no place for, and the folders that may be replaced. */
#define _GNU_SOURCE /* fdopendir, openat */
#include "formats/neuroglancer/neuroglancer_format.h"
#include "core/base/status.h"

#include <dirent.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { INFO_BYTES = 65536, FEW_BITS = 10, MANY_BITS = 16 };
static const char TYPE[] = "neuroglancer_multilod_draco", PROPERTIES[] = "segment_properties";

static cw_status check_request(const cw_write_desc *desc, cw_error *err)
{
    if (desc->bits && desc->bits != FEW_BITS && desc->bits != MANY_BITS)
        return cwi_fail(err, CW_ERR_ARGUMENT, "%d bits a coordinate; neuroglancer has %d or %d",
                        desc->bits, FEW_BITS, MANY_BITS);
    if (desc->axes.unit != CW_UNIT_MM)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "neuroglancer is in nanometres: it has no other unit");
    if (desc->local)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "neuroglancer is in the world: it has no place for a local origin");
    return CW_OK;
}

/* Returns true for `info` and, of meshes, for a segment's two files, or a shard. */
static bool is_own_file(int folder, const char *name, bool is_inner)
{
    struct stat info;
    const size_t digits = strspn(name, "0123456789");
    const size_t hex = strspn(name, "0123456789abcdef");
    const bool is_segment =
        (digits && (!name[digits] || strcmp(name + digits, ".index") == 0)) ||
        (hex && strcmp(name + hex, ".shard") == 0);
    return (strcmp(name, "info") == 0 || (is_segment && !is_inner)) &&
           fstatat(folder, name, &info, AT_SYMLINK_NOFOLLOW) == 0 && S_ISREG(info.st_mode);
}

static DIR *list_folder(int folder, const char *name)
{
    const int fd = openat(folder, name, O_RDONLY | O_DIRECTORY | O_CLOEXEC | O_NOFOLLOW);
    DIR *dir = fd >= 0 ? fdopendir(fd) : NULL;
    if (!dir && fd >= 0)
        close(fd);
    return dir;
}

static cw_status fail_foreign(const char *name, cw_error *err)
{
    return cwi_fail(err, CW_ERR_OUTPUT,
                    "the folder exists and holds '%s', which is not of a neuroglancer mesh",
                    name);
}

/* Checks that a folder holds files of such a mesh alone. */
static cw_status check_names(int folder, const char *name, bool is_inner, cw_error *err)
{
    cw_status st = CW_OK;
    DIR *dir = list_folder(folder, name);
    if (!dir)
        return fail_foreign(name, err);
    for (struct dirent *e; st == CW_OK && (e = readdir(dir));) {
        if (strcmp(e->d_name, ".") == 0 || strcmp(e->d_name, "..") == 0)
            continue;
        if (!is_inner && strcmp(e->d_name, PROPERTIES) == 0)
            st = check_names(folder, PROPERTIES, true, err);
        else if (!is_own_file(dirfd(dir), e->d_name, is_inner))
            st = fail_foreign(e->d_name, err);
    }
    closedir(dir);
    return st;
}

/* Checks that an existing folder is such a mesh, and holds nothing else. */
static cw_status check_replaced(int folder, cw_error *err)
{
    char text[INFO_BYTES + 1] = "";
    const int fd = openat(folder, "info", O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    const ssize_t got = fd >= 0 ? read(fd, text, INFO_BYTES) : -1;
    if (fd >= 0)
        close(fd);
    text[got > 0 ? got : 0] = '\0';
    if (!strstr(text, TYPE))
        return cwi_fail(
            err, CW_ERR_OUTPUT,
            "the folder exists, and is no neuroglancer mesh: its file 'info' does not "
            "say %s",
            TYPE);
    return check_names(folder, ".", false, err);
}

const cwi_format_driver cwi_format_neuroglancer = {
    .name = "neuroglancer",
    .extensions = "",
    .about = "Neuroglancer meshes of segments and levels: a folder, nanometres",
    .feature = "draco",
    .lost =
        "normals, colours, scalars, labels of vertices, affine; places between those of the "
        "grid",
    .keeps = CW_KEEPS_SHARING | CW_KEEPS_PLACES | CW_KEEPS_PARTS,
    .write = {.write = cwi_neuroglancer_write,
              .check = check_request,
              .replaces = check_replaced,
              .only = CW_COMPRESS_DRACO,
              .levels = true},
};
