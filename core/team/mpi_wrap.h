/* The functions of the modules `openmpi` and `mpich`: one source, compiled for each. */
#ifndef CORE_TEAM_MPI_WRAP_H
#define CORE_TEAM_MPI_WRAP_H

#include <cubewright/team.h>

/* Ways to end a process when another is lost. */
typedef struct cwi_lost_rank {
    void (*remove_temporaries)(void);
    int exit_code;
} cwi_lost_rank;

typedef struct cwi_mpi_functions {
    /* Initializes MPI, fills in a team of all ranks, and watches them. */
    cw_status (*join)(cw_team *team, const cwi_lost_rank *lost, cw_error *err);
    /* Waits for all ranks, and finalizes MPI. */
    void (*leave)(void);
} cwi_mpi_functions;

#endif
