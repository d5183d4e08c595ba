/* A clock that jumps: a library for LD_PRELOAD, for tests alone. The time of day is off by as many seconds as stand in the file
 * $FATHOM_CLOCK_FILE; the clock that only runs forward is as it is. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <fcntl.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

int clock_gettime(clockid_t clock, struct timespec *now) {
    static int (*real)(clockid_t, struct timespec *);
    static int file = -2;
    if (!real) real = dlsym(RTLD_NEXT, "clock_gettime");
    int done = real(clock, now);
    if (clock != CLOCK_REALTIME || done) return done;
    if (file == -2) {
        const char *path = getenv("FATHOM_CLOCK_FILE");
        file = path ? open(path, O_RDONLY | O_CLOEXEC) : -1;
    }
    char text[32] = "";
    if (file >= 0 && pread(file, text, sizeof text - 1, 0) > 0) now->tv_sec += atol(text);
    return 0;
}
