/* Processes that make one surface together, such as the ranks of MPI. */
#ifndef CUBEWRIGHT_TEAM_H
#define CUBEWRIGHT_TEAM_H

#include <cubewright/core.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { CW_TEAM_MAX = 4096 }; /* processes */

/* A process among those of its team. All call the functions that take a team, in the same order. A
 * zeroed team is a process alone. A program that uses MPI itself fills one in: gather is then
 * MPI_Allgather of bytes, and broadcast MPI_Bcast. */
typedef struct cw_team {
    int rank, size;   /* number of this process, from 0; of all processes */
    int on_this_host; /* processes of the team on this machine */
    /* Gathers `bytes` bytes of each process, in the order of ranks, to `all` of every process. */
    cw_status (*gather)(void *user, const void *mine, size_t bytes, void *all, cw_error *err);
    /* Copies bytes of the process `from` to every other. */
    cw_status (*broadcast)(void *user, int from, void *bytes, size_t size, cw_error *err);
    void *user; /* passed to both */
} cw_team;

/* Returns true if mpirun started this process as one of several: of Open MPI, or of MPICH and its
 * kin. */
CW_API bool cw_team_is_started(void);

/* Initializes MPI and makes a team of all ranks, if cw_team_is_started(); else of this process
 * alone. Once in a process; cw_team_leave() ends it.
 *
 * From then on each process watches the others. When a host has not been heard of for 8 seconds, the
 * process removes its temporary files, says so on stderr and ends, with the exit status of
 * CW_ERR_IO; 3 seconds later it ends its launcher, if that still waits.
 *
 * team     filled on success; end with cw_team_leave()
 * Returns  CW_ERR_UNSUPPORTED  this build has no module for that MPI; CW_ERR_IO: MPI cannot start;
 *          CW_ERR_LIMIT: more than CW_TEAM_MAX processes */
CW_NODISCARD CW_API cw_status cw_team_join(cw_team *team, cw_error *err);

/* Waits for the others, finalizes MPI and zeroes the team. Harmless on a zeroed one.
 * team  zeroed; may be NULL */
CW_API void cw_team_leave(cw_team *team);

/* Gathers bytes as the function of the team does; for a process alone, too.
 *
 * mine     what this process gives, `bytes` bytes
 * bytes    number of bytes of each process
 * all      filled with what all gave, in the order of ranks
 * Returns  what the team's function returned */
CW_NODISCARD CW_API cw_status cw_team_gather(const cw_team *team, const void *mine,
                                             size_t bytes, void *all, cw_error *err);

/* Copies bytes of one process to all others; for a process alone, too.
 *
 * from     rank of the process that sends
 * bytes    what is sent; filled in the others
 * size     number of bytes
 * Returns  what the team's function returned */
CW_NODISCARD CW_API cw_status cw_team_broadcast(const cw_team *team, int from, void *bytes,
                                                size_t size, cw_error *err);

/* Agrees on an outcome: all processes return the status of the lowest rank that failed, with its
 * message; behind "rank 2: ", unless all failed alike. It allocates nothing.
 *
 * status   of this process
 * err      message of this process, replaced where another one failed
 * Returns  the status of the team */
CW_NODISCARD CW_API cw_status cw_team_agree(const cw_team *team, cw_status status,
                                            cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
