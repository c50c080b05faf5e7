/* A team of the ranks of MPI. Compiled once for each MPI: CWI_MPI_MODULE names the struct of
 * functions. */
#define _GNU_SOURCE /* nanosleep */
#include "core/team/mpi_wrap.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/team/mpi_watch.h"

#include <limits.h>
#include <mpi.h>
#include <pthread.h>
#include <string.h>
#include <time.h>

static cw_team joined;
static cwi_rank_watch watch;
static pthread_t watcher;
static bool watches;

static cw_status fail_mpi(int code, const char *what, cw_error *err)
{
    char words[MPI_MAX_ERROR_STRING] = "";
    int length = 0;
    MPI_Error_string(code, words, &length);
    return cwi_fail(err, CW_ERR_IO, "%s: MPI: %.300s", what, words);
}

/* Waits without taking the processor from ranks that still work. */
static int await_request(MPI_Request *request)
{
    long pause = 20000; /* ns */
    int done = 0;
    int code = MPI_Test(request, &done, MPI_STATUS_IGNORE);
    while (code == MPI_SUCCESS && !done) {
        nanosleep(&(struct timespec){.tv_nsec = pause}, NULL);
        pause = pause < 1000000 ? 2 * pause : pause;
        code = MPI_Test(request, &done, MPI_STATUS_IGNORE);
    }
    return code;
}

/* MPI counts bytes by int. */
static cw_status check_bytes(size_t bytes, cw_error *err)
{
    return bytes <= INT_MAX
               ? CW_OK
               : cwi_fail(err, CW_ERR_LIMIT, "ranks exchange %zu bytes; up to %d were expected",
                          bytes, INT_MAX);
}

static cw_status gather_bytes(void *user, const void *mine, size_t bytes, void *all,
                              cw_error *err)
{
    MPI_Request request;
    (void)user;
    cw_status st = check_bytes(bytes, err);
    if (st != CW_OK)
        return st;
    int code = MPI_Iallgather(mine, (int)bytes, MPI_BYTE, all, (int)bytes, MPI_BYTE,
                              MPI_COMM_WORLD, &request);
    if (code == MPI_SUCCESS)
        code = await_request(&request);
    return code == MPI_SUCCESS ? CW_OK : fail_mpi(code, "the ranks cannot gather", err);
}

static cw_status broadcast_bytes(void *user, int from, void *bytes, size_t size, cw_error *err)
{
    MPI_Request request;
    (void)user;
    cw_status st = check_bytes(size, err);
    if (st != CW_OK)
        return st;
    int code = MPI_Ibcast(bytes, (int)size, MPI_BYTE, from, MPI_COMM_WORLD, &request);
    if (code == MPI_SUCCESS)
        code = await_request(&request);
    return code == MPI_SUCCESS ? CW_OK : fail_mpi(code, "a rank cannot tell the others", err);
}

static void await_all(void)
{
    MPI_Request request;
    if (MPI_Ibarrier(MPI_COMM_WORLD, &request) == MPI_SUCCESS)
        await_request(&request);
}

/* Gathers the names of the ranks' hosts, and counts those here. */
static cw_status name_hosts(cw_team *team, cw_error *err)
{
    char name[MPI_MAX_PROCESSOR_NAME] = "", mine[CWI_HOST_NAME] = "";
    int length = 0;
    MPI_Get_processor_name(name, &length);
    memcpy(mine, name, length < CWI_HOST_NAME ? (size_t)length : CWI_HOST_NAME - 1);
    watch.hosts = cwi_alloc_array((size_t)team->size, sizeof *watch.hosts);
    if (!watch.hosts)
        return cwi_fail_memory(err);
    cw_status st = gather_bytes(NULL, mine, sizeof mine, watch.hosts, err);
    team->on_this_host = 0;
    for (int r = 0; r < team->size && st == CW_OK; r++)
        team->on_this_host += strcmp(watch.hosts[r], mine) == 0;
    return st;
}

static cw_status join_ranks(cw_team *team, const cwi_lost_rank *lost, cw_error *err)
{
    int level = MPI_THREAD_SINGLE;
    int code = MPI_Init_thread(NULL, NULL, MPI_THREAD_MULTIPLE, &level);
    if (code != MPI_SUCCESS)
        return cwi_fail(err, CW_ERR_IO, "MPI cannot start: error %d", code);
    MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN);
    *team = (cw_team){.gather = gather_bytes, .broadcast = broadcast_bytes};
    MPI_Comm_rank(MPI_COMM_WORLD, &team->rank);
    MPI_Comm_size(MPI_COMM_WORLD, &team->size);
    cw_status st =
        team->size > CW_TEAM_MAX
            ? cwi_fail(err, CW_ERR_LIMIT, "%d ranks; there may be %d", team->size, CW_TEAM_MAX)
            : name_hosts(team, err);
    if (st != CW_OK)
        return st;
    joined = *team;
    watch.team = &joined;
    watch.lost = *lost;
    /* an MPI without threads has no watch */
    watches = level == MPI_THREAD_MULTIPLE && cwi_open_watch() &&
              pthread_create(&watcher, NULL, cwi_watch_ranks, &watch) == 0;
    return CW_OK;
}

/* The ranks watch each other until all are here. */
static void leave_ranks(void)
{
    await_all();
    if (watches) {
        atomic_store(&watch.stops, true);
        pthread_join(watcher, NULL);
        await_all();
        cwi_close_watch();
    }
    cwi_free(watch.hosts);
    watch.hosts = NULL;
    MPI_Finalize();
}

CW_API extern const cwi_mpi_functions CWI_MPI_MODULE;
const cwi_mpi_functions CWI_MPI_MODULE = {join_ranks, leave_ranks};
