/* A disk that refuses writes or reads: a library for LD_PRELOAD, for tests alone. While the file $FATHOM_EIO_FLAG exists, writes
 * and syncs of files below $FATHOM_EIO_FOLDER fail with EIO. Reads of the byte $FATHOM_EIO_READ_AT of the file $FATHOM_EIO_READ_FILE
 * always do. */
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

static int is_unreadable(int file, size_t length, off64_t offset) {
    const char *target = getenv("FATHOM_EIO_READ_FILE"), *at = getenv("FATHOM_EIO_READ_AT");
    int before = errno, result = 0;
    char link[64], path[PATH_MAX];
    if (target && at && offset >= 0 && offset <= atoll(at) && atoll(at) < offset + (off64_t)length) {
        snprintf(link, sizeof link, "/proc/self/fd/%d", file);
        ssize_t end = readlink(link, path, sizeof path - 1);
        result = end == (ssize_t)strlen(target) && !strncmp(path, target, end);
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
ssize_t read(int file, void *bytes, size_t length) {
    NEXT(ssize_t, "read", (int, void *, size_t));
    int before = errno;
    off64_t offset = getenv("FATHOM_EIO_READ_FILE") ? lseek64(file, 0, SEEK_CUR) : -1;
    errno = before;
    return is_unreadable(file, length, offset) ? -1 : real(file, bytes, length);
}
ssize_t pread64(int file, void *bytes, size_t length, off64_t offset) {
    NEXT(ssize_t, "pread64", (int, void *, size_t, off64_t));
    return is_unreadable(file, length, offset) ? -1 : real(file, bytes, length, offset);
}
ssize_t pread(int file, void *bytes, size_t length, off_t offset) {
    NEXT(ssize_t, "pread", (int, void *, size_t, off_t));
    return is_unreadable(file, length, offset) ? -1 : real(file, bytes, length, offset);
}
