/* Watches ranks: each tells rank 0 every second that it is there, and rank 0 tells each. TCP alone
 * would notice a lost host after many minutes. */
#define _GNU_SOURCE /* nanosleep, setsid */
#include "core/team/mpi_watch.h"

#include "core/base/memory.h"

#include <fcntl.h>
#include <mpi.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

enum { BEATS_S = 1, SILENT_S = 8, GRACE_S = 3, TAG = 1 };

static MPI_Comm beats = MPI_COMM_NULL;

bool cwi_open_watch(void)
{
    return MPI_Comm_dup(MPI_COMM_WORLD, &beats) == MPI_SUCCESS;
}

/* A rank that is listened to: rank 0 by all, and all by rank 0. */
typedef struct peer {
    int rank;
    bool sends;
    MPI_Request heard, sent;
    double last; /* time of its last beat */
    char in, out;
} peer;

static double read_clock(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Returns true for a process with the name of an MPI launcher or its daemon. */
static bool is_launcher(pid_t process)
{
    static const char *const names[] = {"mpirun",  "mpiexec",         "orterun",
                                        "orted",   "hydra_pmi_proxy", "prted",
                                        "prterun", "mpirun.openmpi"};
    char path[64], name[32] = "";
    snprintf(path, sizeof path, "/proc/%d/comm", (int)process);
    const int file = open(path, O_RDONLY | O_CLOEXEC);
    const ssize_t size = file >= 0 ? read(file, name, sizeof name - 1) : 0;
    if (file >= 0)
        close(file);
    if (size > 0 && name[size - 1] == '\n')
        name[size - 1] = '\0';
    for (size_t n = 0; n < sizeof names / sizeof *names; n++)
        if (strncmp(name, names[n], 15) == 0) /* the kernel keeps 15 letters */
            return true;
    return false;
}

/* Ends the launcher after some time, if it is still there then: it may wait for a lost host for
 * ever, deaf to SIGTERM. A process of its own does that, in a session of its own. */
static void end_launcher_later(void)
{
    const pid_t launcher = getppid();
    if (!is_launcher(launcher) || fork() != 0)
        return;
    setsid();
    for (int file = 0; file < 256; file++)
        close(file);
    for (double until = read_clock() + GRACE_S; read_clock() < until;)
        nanosleep(&(struct timespec){.tv_nsec = 100000000}, NULL);
    if (is_launcher(launcher))
        kill(launcher, SIGKILL);
    _exit(0);
}

static _Noreturn void end_job(const cwi_rank_watch *w, int lost)
{
    char line[256];
    const int length =
        snprintf(line, sizeof line,
                 "cubewright: rank %d on host %s has not been heard of for %d s: the job ends. "
                 "Parts that were kept stay: run the same command again\n",
                 lost, w->hosts[lost], SILENT_S);
    const ssize_t written = write(STDERR_FILENO, line, (size_t)length);
    (void)written;
    w->lost.remove_temporaries();
    end_launcher_later();
    signal(SIGALRM, SIG_DFL);
    alarm(1); /* MPI_Abort may wait for the lost host, too */
    MPI_Abort(MPI_COMM_WORLD, w->lost.exit_code);
    _exit(w->lost.exit_code);
}

static void listen_to(peer *p)
{
    p->heard = MPI_REQUEST_NULL;
    MPI_Irecv(&p->in, 1, MPI_CHAR, p->rank, TAG, beats, &p->heard);
}

static void hear_peer(peer *p, double now)
{
    int done = 1;
    while (done) {
        MPI_Test(&p->heard, &done, MPI_STATUS_IGNORE);
        if (done) {
            p->last = now;
            listen_to(p);
        }
    }
}

static void send_beat(peer *p)
{
    int done = 1;
    if (p->sends)
        MPI_Test(&p->sent, &done, MPI_STATUS_IGNORE);
    if (!done)
        return; /* the last one is still on its way */
    p->sends = true;
    MPI_Isend(&p->out, 1, MPI_CHAR, p->rank, TAG, beats, &p->sent);
}

static void end_peer(peer *p)
{
    MPI_Cancel(&p->heard);
    MPI_Wait(&p->heard, MPI_STATUS_IGNORE);
    if (p->sends)
        MPI_Wait(&p->sent, MPI_STATUS_IGNORE);
}

void *cwi_watch_ranks(void *watch)
{
    const cwi_rank_watch *w = watch;
    const int count = w->team->rank == 0 ? w->team->size - 1 : 1;
    peer *peers = cwi_alloc_zeroed((size_t)count, sizeof *peers);
    double next = read_clock(), start = next;
    if (!peers)
        return NULL; /* without a watch */
    for (int n = 0; n < count; n++) {
        peers[n].rank = w->team->rank == 0 ? n + 1 : 0;
        peers[n].last = start;
        listen_to(peers + n);
    }
    while (!atomic_load(&w->stops)) {
        const double now = read_clock();
        const bool beat = now >= next;
        next = beat ? now + BEATS_S : next;
        for (int n = 0; n < count; n++) {
            hear_peer(peers + n, now);
            if (beat)
                send_beat(peers + n);
            if (now - peers[n].last > SILENT_S)
                end_job(w, peers[n].rank);
        }
        nanosleep(&(struct timespec){.tv_nsec = 20000000}, NULL);
    }
    for (int n = 0; n < count; n++)
        end_peer(peers + n);
    cwi_free(peers);
    return NULL;
}

/* Receives beats that were on their way when the watches ended. */
void cwi_close_watch(void)
{
    int waits = 1;
    MPI_Status from;
    char beat;
    MPI_Iprobe(MPI_ANY_SOURCE, TAG, beats, &waits, &from);
    while (waits) {
        MPI_Recv(&beat, 1, MPI_CHAR, from.MPI_SOURCE, TAG, beats, MPI_STATUS_IGNORE);
        MPI_Iprobe(MPI_ANY_SOURCE, TAG, beats, &waits, &from);
    }
    MPI_Comm_free(&beats);
}
