/* Joins the spools of the processes of a team. No array is sent: each process opens the files of the
 * others. */
#define _GNU_SOURCE /* linkat of an open file */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/files/temporary_name.h"
#include "core/geometry/box.h"
#include "formats/mesh/mesh_spool.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* Description of a process's part, for the others. */
typedef struct member {
    uint64_t vertices, triangles;
    double origin[3], affine[3][4];
    double low[3], high[3];
    int32_t has_normals;
    char names[CWI_SPOOL_FILES][CWI_FILE_NAME_BYTES]; /* of its files, in the shared folder */
} member;

static cw_status fail_file(const char *what, const char *folder, cw_error *err)
{
    return cwi_fail(err, CW_ERR_OUTPUT, "%s in '%s': %s", what, folder, strerror(errno));
}

/* Copies a file without a name to one that has one, where a file system cannot name it. */
static cw_status copy_file(int *file, const char *path, size_t elements, const char *folder,
                           cw_error *err)
{
    enum { PIECE = CWI_SPOOL_PIECE };
    const int to = open(path, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
    void *piece = cwi_alloc_array(PIECE, CWI_SPOOL_ELEMENT);
    cw_status st = to < 0 ? fail_file("no temporary file", folder, err) : CW_OK;
    if (!piece)
        st = cwi_fail_memory(err);
    for (size_t n = 0; n < elements && st == CW_OK; n += PIECE) {
        const size_t count = elements - n < PIECE ? elements - n : PIECE;
        st = cwi_read_elements(*file, n, count, piece, err);
        if (st == CW_OK)
            st = cwi_write_elements(folder, to, n, piece, count, err);
    }
    if (st == CW_OK && fsync(to) != 0) /* other machines read it */
        st = fail_file("a temporary file cannot be written", folder, err);
    cwi_free(piece);
    if (st != CW_OK && to >= 0)
        close(to);
    if (st == CW_OK) {
        close(*file);
        *file = to;
    }
    return st;
}

/* Gives the files of a spool names that no other process uses. */
static cw_status name_files(cw_mesh_spool *s, member *m, cw_error *err)
{
    cw_status st = CW_OK;
    for (int n = 0; n < CWI_SPOOL_FILES && st == CW_OK; n++) {
        char open_file[64], path[PATH_MAX];
        cwi_name_temporary("cubewright", m->names[n]);
        snprintf(open_file, sizeof open_file, "/proc/self/fd/%d", s->mine.files[n]);
        if (snprintf(path, sizeof path, "%s/%s", s->folder, m->names[n]) >= PATH_MAX)
            st = cwi_fail(err, CW_ERR_OUTPUT, "the path of '%s' is too long", s->folder);
        else if (linkat(AT_FDCWD, open_file, AT_FDCWD, path, AT_SYMLINK_FOLLOW) != 0)
            st = copy_file(&s->mine.files[n], path,
                           n == CWI_SPOOL_TRIANGLES ? s->mine.triangles : s->mine.vertices,
                           s->folder, err);
    }
    return st;
}

static void remove_names(const cw_mesh_spool *s, const member *m)
{
    char path[PATH_MAX];
    for (int n = 0; n < CWI_SPOOL_FILES; n++)
        if (m->names[n][0] &&
            snprintf(path, sizeof path, "%s/%s", s->folder, m->names[n]) < PATH_MAX)
            unlink(path);
}

static cw_status open_segment(const cw_mesh_spool *s, const member *m, cwi_spool_segment *g,
                              cw_error *err)
{
    for (int n = 0; n < CWI_SPOOL_FILES; n++) {
        char path[PATH_MAX];
        if (snprintf(path, sizeof path, "%s/%.255s", s->folder, m->names[n]) >= PATH_MAX)
            return cwi_fail(err, CW_ERR_OUTPUT, "the path of '%s' is too long", s->folder);
        g->files[n] = open(path, O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
        if (g->files[n] < 0)
            return cwi_fail(err, CW_ERR_IO,
                            "a file that another process made in '%s' is not seen here: %s; "
                            "all processes need the same folder",
                            s->folder, strerror(errno));
    }
    return CW_OK;
}

/* Places the segments of all members one behind the other, and opens their files. */
static cw_status open_segments(cw_mesh_spool *s, const member *members, const cw_team *team,
                               cwi_spool_segment *segments, cw_error *err)
{
    size_t vertex = 0, triangle = 0;
    cw_status st = CW_OK;
    for (int r = 0; r < team->size; r++) {
        const member *m = members + r;
        segments[r] = (cwi_spool_segment){.files = {-1, -1, -1},
                                          .first_vertex = vertex,
                                          .vertices = (size_t)m->vertices,
                                          .first_triangle = triangle,
                                          .triangles = (size_t)m->triangles};
        if (r == team->rank)
            memcpy(segments[r].files, s->mine.files, sizeof s->mine.files);
        else if (st == CW_OK)
            st = open_segment(s, m, segments + r, err);
        vertex += segments[r].vertices;
        triangle += segments[r].triangles;
    }
    s->segments = segments;
    s->segment_count = (size_t)team->size;
    s->own = (size_t)team->rank;
    s->frame.vertex_count = vertex;
    s->frame.triangle_count = triangle;
    return st == CW_OK && vertex > UINT32_MAX
               ? cwi_fail(err, CW_ERR_LIMIT,
                          "the surface has %zu vertices; a mesh has at most %u", vertex,
                          UINT32_MAX)
               : st;
}

/* Takes the frame of a member that has a surface, and the box around all. */
static void join_frames(cw_mesh_spool *s, const member *members, int count)
{
    for (int r = 0; r < count; r++) {
        const member *m = members + r;
        if (!m->vertices)
            continue;
        memcpy(s->frame.origin, m->origin, sizeof m->origin);
        memcpy(s->frame.affine, m->affine, sizeof m->affine);
        s->has_normals = m->has_normals;
        cwi_box_join(s->low, s->high, m->low, m->high);
    }
}

static void describe_member(const cw_mesh_spool *s, member *m)
{
    *m = (member){.vertices = s->mine.vertices,
                  .triangles = s->mine.triangles,
                  .has_normals = s->has_normals};
    memcpy(m->origin, s->frame.origin, sizeof m->origin);
    memcpy(m->affine, s->frame.affine, sizeof m->affine);
    memcpy(m->low, s->low, sizeof m->low);
    memcpy(m->high, s->high, sizeof m->high);
}

cw_status cw_mesh_spool_share(cw_mesh_spool *s, const cw_team *team, cw_error *err)
{
    CWI_REQUIRE(err, s, team);
    const size_t count = team->size > 1 ? (size_t)team->size : 1;
    if (count == 1)
        return CW_OK;
    member *mine = cwi_alloc_zeroed(1, sizeof *mine);
    member *members = cwi_alloc_array(count, sizeof *members);
    cwi_spool_segment *segments = cwi_alloc_array(count, sizeof *segments);
    cw_status st = mine && members && segments ? CW_OK : cwi_fail_memory(err);
    if (st == CW_OK && s->team)
        st = cwi_fail(err, CW_ERR_ARGUMENT, "a spool that is shared already");
    st = cw_team_agree(team, st, err); /* all are done: files have names for a moment only */
    if (st == CW_OK) {
        describe_member(s, mine);
        st = cw_team_agree(team, name_files(s, mine, err), err);
    }
    if (st == CW_OK)
        st = cw_team_gather(team, mine, sizeof *mine, members, err);
    if (st == CW_OK) {
        st = open_segments(s, members, team, segments, err);
        segments = NULL; /* the spool has them */
        join_frames(s, members, team->size);
        s->team = team;
        st = cw_team_agree(team, st, err);
    }
    if (mine)
        remove_names(s, mine);
    cwi_free(segments);
    cwi_free(members);
    cwi_free(mine);
    return st;
}
