/* Preloaded into a process: a write to a chosen file fails, the k-th one only or all from there on. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/sendfile.h>
#include <sys/types.h>
#include <sys/uio.h>
#include <unistd.h>

enum { SHORT = 0, KILL = -1 }; /* other faults are numbers of errors */

static char file[256];
static int first, fault, lasting, calls;

/* Begin to count the writes to files whose path contains a text; the one with this number fails. */
void arm(const char *text, int number, int kind, int from_then_on) {
    strncpy(file, text, sizeof file - 1);
    first = number, fault = kind, lasting = from_then_on, calls = 0;
}

/* Number of writes since then. */
int counted(void) { return calls; }

/* Number of the error with which a call fails, SHORT for half a write, KILL for none. */
static int failure(int descriptor) {
    char link[64], path[4096];
    if (!*file) return KILL;
    snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
    ssize_t length = readlink(link, path, sizeof path - 1);
    if (length < 0) return KILL;
    path[length] = 0;
    if (!strstr(path, file)) return KILL;
    int call = __atomic_add_fetch(&calls, 1, __ATOMIC_SEQ_CST);
    if (call < first || (call > first && !lasting)) return KILL;
    if (fault == KILL) raise(SIGKILL);
    return fault == SHORT && call > first ? ENOSPC : fault; /* a disk that is full takes part of one write, then none */
}

#define REAL(name) static __typeof__(name) *real; if (!real) real = dlsym(RTLD_NEXT, #name)
#define WRITE(type, name, declared, given) \
    type name declared { \
        REAL(name); \
        int error = failure(fd); \
        if (error > 0) { errno = error; return -1; } \
        if (error == SHORT && size > 1) size /= 2; \
        return real given; \
    }
#define CHANGE(name, declared, given, result) \
    int name declared { \
        REAL(name); \
        int error = failure(fd); \
        if (error == SHORT) error = ENOSPC; \
        if (error > 0) { errno = error; return result; } \
        return real given; \
    }

WRITE(ssize_t, write, (int fd, const void *data, size_t size), (fd, data, size))
WRITE(ssize_t, pwrite, (int fd, const void *data, size_t size, off_t at), (fd, data, size, at))
WRITE(ssize_t, pwrite64, (int fd, const void *data, size_t size, off64_t at), (fd, data, size, at))
WRITE(ssize_t, sendfile, (int fd, int from, off_t *at, size_t size), (fd, from, at, size))
WRITE(ssize_t, sendfile64, (int fd, int from, off64_t *at, size_t size), (fd, from, at, size))
CHANGE(ftruncate, (int fd, off_t size), (fd, size), -1)
CHANGE(ftruncate64, (int fd, off64_t size), (fd, size), -1)
CHANGE(fsync, (int fd), (fd), -1)
CHANGE(posix_fallocate, (int fd, off_t at, off_t size), (fd, at, size), error)
CHANGE(posix_fallocate64, (int fd, off64_t at, off64_t size), (fd, at, size), error)
