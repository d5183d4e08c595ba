/* A disk that refuses writes: a library for LD_PRELOAD, for tests alone. While the file $FATHOM_EIO_FLAG exists, writes and syncs
 * of files below $FATHOM_EIO_FOLDER fail with EIO. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static int fails(int file) {
    static const char *folder, *flag;
    int before = errno, result = 0;
    char link[64], path[PATH_MAX];
    if (!folder) {
        folder = getenv("FATHOM_EIO_FOLDER");
        flag = getenv("FATHOM_EIO_FLAG");
    }
    if (folder && flag && !access(flag, F_OK)) {
        snprintf(link, sizeof link, "/proc/self/fd/%d", file);
        ssize_t length = readlink(link, path, sizeof path - 1);
        size_t prefix = strlen(folder);
        result = length > (ssize_t)prefix && !strncmp(path, folder, prefix) && path[prefix] == '/';
    }
    errno = result ? EIO : before;
    return result;
}

#define NEXT(type, name, parameters)                          \
    static type (*real) parameters;                            \
    if (!real) real = (type(*) parameters)dlsym(RTLD_NEXT, name)

ssize_t write(int file, const void *bytes, size_t length) {
    NEXT(ssize_t, "write", (int, const void *, size_t));
    return fails(file) ? -1 : real(file, bytes, length);
}
ssize_t pwrite64(int file, const void *bytes, size_t length, off64_t offset) {
    NEXT(ssize_t, "pwrite64", (int, const void *, size_t, off64_t));
    return fails(file) ? -1 : real(file, bytes, length, offset);
}
ssize_t pwrite(int file, const void *bytes, size_t length, off_t offset) {
    NEXT(ssize_t, "pwrite", (int, const void *, size_t, off_t));
    return fails(file) ? -1 : real(file, bytes, length, offset);
}
int fsync(int file) {
    NEXT(int, "fsync", (int));
    return fails(file) ? -1 : real(file);
}
int fdatasync(int file) {
    NEXT(int, "fdatasync", (int));
    return fails(file) ? -1 : real(file);
}
