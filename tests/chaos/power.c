/* A disk that loses what was not synced: a library for LD_PRELOAD, for tests alone.
 *
 * It follows the files below $FATHOM_POWER_FOLDER. Writes go to the real files, and each is noted in $FATHOM_POWER_LOG with the
 * bytes that it replaced until fsync or fdatasync of its file makes it safe. A new name, a rename and a removal are noted until
 * fsync of their folder. At the cut, when the $FATHOM_POWER_CUT-th write comes, the process ends at once. `tests/suite/faults/power.rs` then
 * takes back what was not safe: all of it, or what a seed chooses, whole or torn at a sector.
 *
 * The log has one line for each event, written with one call before the event happens:
 *   W path offset length old-length HEX   bytes [offset, offset+length) will change; HEX are those of before, as far as there were
 *   T path length old-length HEX          will be cut or extended; HEX are the bytes that are lost
 *   S path                                file is synced (after)
 *   C path                                a name is new
 *   R from to                             will be renamed; what was `to` is kept under `to`.cut-N, whose name follows
 *   U path kept                           will be removed; kept under the second name
 *   D folder                              folder is synced (after)
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

#define MOST 65536

static char *paths[MOST];
static pthread_mutex_t turn = PTHREAD_RECURSIVE_MUTEX_INITIALIZER_NP;
static const char *folder;
static size_t folder_length;
static int journal = -1;
static long cut = -1, writes, kept;

static ssize_t (*real_write)(int, const void *, size_t);
static ssize_t (*real_pwrite)(int, const void *, size_t, off64_t);
static int (*real_open)(const char *, int, ...);
static int (*real_openat)(int, const char *, int, ...);
static int (*real_close)(int);
static int (*real_fsync)(int);
static int (*real_fdatasync)(int);
static int (*real_ftruncate)(int, off64_t);
static int (*real_rename)(const char *, const char *);
static int (*real_unlink)(const char *);
static int (*real_link)(const char *, const char *);

static int below(const char *path) {
    return folder && path && !strncmp(path, folder, folder_length) && path[folder_length] == '/';
}

/* Memory that processes share, and files that are made anew each time, are no data. */
static int counts(const char *path) {
    size_t length = strlen(path);
    if (length > 4 && !strcmp(path + length - 4, "-shm")) return 0;
    if (strstr(path, "/space.") || strstr(path, "/styles") || strstr(path, "/lock")) return 0;
    return 1;
}

static void note(const char *text, size_t length) {
    while (length > 0) {
        ssize_t done = real_write(journal, text, length);
        if (done <= 0) _exit(99);
        text += done;
        length -= (size_t)done;
    }
}

__attribute__((constructor)) static void start(void) {
    real_write = dlsym(RTLD_NEXT, "write");
    real_pwrite = dlsym(RTLD_NEXT, "pwrite64");
    real_open = dlsym(RTLD_NEXT, "open64");
    real_openat = dlsym(RTLD_NEXT, "openat64");
    real_close = dlsym(RTLD_NEXT, "close");
    real_fsync = dlsym(RTLD_NEXT, "fsync");
    real_fdatasync = dlsym(RTLD_NEXT, "fdatasync");
    real_ftruncate = dlsym(RTLD_NEXT, "ftruncate64");
    real_rename = dlsym(RTLD_NEXT, "rename");
    real_unlink = dlsym(RTLD_NEXT, "unlink");
    real_link = dlsym(RTLD_NEXT, "link");
    const char *log = getenv("FATHOM_POWER_LOG");
    const char *at = getenv("FATHOM_POWER_CUT");
    folder = getenv("FATHOM_POWER_FOLDER");
    if (!folder || !log) {
        folder = NULL;
        return;
    }
    folder_length = strlen(folder);
    journal = real_open(log, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
    cut = at ? atol(at) : -1;
    /* Workers write nothing here. */
    unsetenv("LD_PRELOAD");
}

static void step(void) {
    if (cut >= 0 && ++writes >= cut) {
        note("END\n", 4);
        _exit(137);
    }
}

static const char *path_of(int fd) {
    return fd >= 0 && fd < MOST ? paths[fd] : NULL;
}

static char *absolute(const char *path, char *buffer) {
    if (path[0] == '/') return strcpy(buffer, path);
    if (!getcwd(buffer, 2048)) return NULL;
    strcat(strcat(buffer, "/"), path);
    return buffer;
}

static void opened(int fd, const char *given, int is_new) {
    char buffer[8192], line[8300];
    if (!folder || fd < 0 || fd >= MOST) return;
    char *path = absolute(given, buffer);
    if (!path || !below(path) || !counts(path)) return;
    pthread_mutex_lock(&turn);
    free(paths[fd]);
    paths[fd] = strdup(path);
    if (is_new) note(line, (size_t)snprintf(line, sizeof line, "C\t%s\n", path));
    pthread_mutex_unlock(&turn);
}

static void before_change(char kind, int fd, const char *path, off64_t offset, size_t length) {
    static const char digits[] = "0123456789abcdef";
    struct stat64 about;
    if (fstat64(fd, &about)) return;
    off64_t end = kind == 'T' ? about.st_size : (off64_t)(offset + (off64_t)length);
    if (end > about.st_size) end = about.st_size;
    size_t old = end > offset ? (size_t)(end - offset) : 0;
    char *line = malloc(9000 + 2 * old);
    unsigned char *bytes = malloc(old + 1);
    size_t at = (size_t)sprintf(line, "%c\t%s\t%lld\t%zu\t%lld\t", kind, path, (long long)offset, length, (long long)about.st_size);
    int reader = real_open(path, O_RDONLY | O_CLOEXEC);
    ssize_t got = reader >= 0 ? pread64(reader, bytes, old, offset) : 0;
    if (reader >= 0) real_close(reader);
    for (ssize_t i = 0; i < got; i++) {
        line[at++] = digits[bytes[i] >> 4];
        line[at++] = digits[bytes[i] & 15];
    }
    line[at++] = '\n';
    note(line, at);
    free(bytes);
    free(line);
}

static int open_any(int (*call)(const char *, int, ...), const char *path, int flags, mode_t mode) {
    int was = folder && (flags & O_CREAT) ? access(path, F_OK) == 0 : 1;
    int fd = call(path, flags, mode);
    if (fd >= 0 && ((flags & O_ACCMODE) != O_RDONLY || (flags & O_DIRECTORY) || folder)) opened(fd, path, !was);
    if (fd >= 0 && (flags & O_TRUNC) && was && path_of(fd)) note("# truncated while opened\n", 25);
    return fd;
}

#define MODE                                      \
    mode_t mode = 0;                              \
    if (flags & (O_CREAT | O_TMPFILE)) {          \
        va_list rest;                             \
        va_start(rest, flags);                    \
        mode = va_arg(rest, mode_t);              \
        va_end(rest);                             \
    }

int open(const char *path, int flags, ...) { MODE return open_any(real_open, path, flags, mode); }
int open64(const char *path, int flags, ...) { MODE return open_any(real_open, path, flags, mode); }

int openat(int at, const char *path, int flags, ...) {
    MODE
    if (at == AT_FDCWD || path[0] == '/') return open_any(real_open, path, flags, mode);
    return real_openat(at, path, flags, mode);
}
int openat64(int at, const char *path, int flags, ...) {
    MODE
    if (at == AT_FDCWD || path[0] == '/') return open_any(real_open, path, flags, mode);
    return real_openat(at, path, flags, mode);
}

int close(int fd) {
    pthread_mutex_lock(&turn);
    if (fd >= 0 && fd < MOST && paths[fd]) {
        free(paths[fd]);
        paths[fd] = NULL;
    }
    pthread_mutex_unlock(&turn);
    return real_close(fd);
}

static ssize_t write_at(int fd, const void *bytes, size_t length, off64_t offset) {
    pthread_mutex_lock(&turn);
    const char *path = path_of(fd);
    if (path) {
        step();
        before_change('W', fd, path, offset, length);
    }
    ssize_t done = real_pwrite(fd, bytes, length, offset);
    pthread_mutex_unlock(&turn);
    return done;
}

ssize_t pwrite(int fd, const void *bytes, size_t length, off_t offset) { return write_at(fd, bytes, length, offset); }
ssize_t pwrite64(int fd, const void *bytes, size_t length, off64_t offset) { return write_at(fd, bytes, length, offset); }

ssize_t write(int fd, const void *bytes, size_t length) {
    if (!path_of(fd)) return real_write(fd, bytes, length);
    pthread_mutex_lock(&turn);
    const char *path = path_of(fd);
    if (path) {
        off64_t offset = lseek64(fd, 0, SEEK_CUR);
        struct stat64 about;
        if ((fcntl(fd, F_GETFL) & O_APPEND) && !fstat64(fd, &about)) offset = about.st_size;
        step();
        before_change('W', fd, path, offset, length);
    }
    ssize_t done = real_write(fd, bytes, length);
    pthread_mutex_unlock(&turn);
    return done;
}

static int cut_to(int fd, off64_t length) {
    pthread_mutex_lock(&turn);
    const char *path = path_of(fd);
    if (path) {
        step();
        before_change('T', fd, path, length, 0);
    }
    int done = real_ftruncate(fd, length);
    pthread_mutex_unlock(&turn);
    return done;
}

int ftruncate(int fd, off_t length) { return cut_to(fd, length); }
int ftruncate64(int fd, off64_t length) { return cut_to(fd, length); }

static int synced(int fd, int (*call)(int)) {
    char line[8300];
    pthread_mutex_lock(&turn);
    const char *path = path_of(fd);
    if (path) step();
    int done = call(fd);
    if (path && !done) {
        struct stat64 about;
        int is_folder = !fstat64(fd, &about) && S_ISDIR(about.st_mode);
        note(line, (size_t)snprintf(line, sizeof line, "%c\t%s\n", is_folder ? 'D' : 'S', path));
    }
    pthread_mutex_unlock(&turn);
    return done;
}

int fsync(int fd) { return synced(fd, real_fsync); }
int fdatasync(int fd) { return synced(fd, real_fdatasync); }

/* Keeps what a name stands for under another name, which is not below the folder's own names. */
static void keep(const char *path, char *other) {
    sprintf(other, "%s.cut-%ld", path, ++kept);
    if (real_link(path, other)) other[0] = '\0';
}

int rename(const char *from, const char *to) {
    char a[8192], b[8192], other[8300], line[26000];
    pthread_mutex_lock(&turn);
    if (folder && absolute(from, a) && absolute(to, b) && below(b) && counts(b)) {
        step();
        keep(b, other);
        note(line, (size_t)snprintf(line, sizeof line, "R\t%s\t%s\t%s\n", a, b, other));
        for (int fd = 0; fd < MOST; fd++)
            if (paths[fd] && !strcmp(paths[fd], a)) {
                free(paths[fd]);
                paths[fd] = strdup(b);
            }
    }
    int done = real_rename(from, to);
    pthread_mutex_unlock(&turn);
    return done;
}

int unlink(const char *path) {
    char a[8192], other[8300], line[17000];
    pthread_mutex_lock(&turn);
    if (folder && absolute(path, a) && below(a) && counts(a) && access(a, F_OK) == 0) {
        step();
        keep(a, other);
        note(line, (size_t)snprintf(line, sizeof line, "U\t%s\t%s\n", a, other));
    }
    int done = real_unlink(path);
    pthread_mutex_unlock(&turn);
    return done;
}
