/* A thread that notices when the host of a rank is lost. */
#ifndef CORE_TEAM_MPI_WATCH_H
#define CORE_TEAM_MPI_WATCH_H

#include "core/team/mpi_wrap.h"

#include <stdatomic.h>

enum { CWI_HOST_NAME = 64 };

/* A watch over the ranks of a communicator. */
typedef struct cwi_rank_watch {
    const cw_team *team;
    cwi_lost_rank lost;
    char (*hosts)[CWI_HOST_NAME]; /* names, one for a rank */
    atomic_bool stops;
} cwi_rank_watch;

/* Watches until `stops`; for pthread_create(). Ends the process when a rank is silent. */
void *cwi_watch_ranks(void *watch);

/* Opens and closes the communicator of the watch. All ranks call both. */
bool cwi_open_watch(void);
void cwi_close_watch(void);

#endif
