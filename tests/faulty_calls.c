/* Calls of the system on files below a folder of which one fails, is cut short, or ends the process: for `faults.py`. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/types.h>
#include <sys/uio.h>
#include <unistd.h>

enum { NOTHING, EIO_ONCE, NO_SPACE, SHORT, KILL, EIO_FROM_NOW_ON };

static char below[PATH_MAX];
static long number = -1, calls = 0;
static int kind = NOTHING;

void begin_faults(const char *folder, long which, int what) {
    strncpy(below, folder, sizeof below - 1);
    number = which, kind = what, calls = 0;
}

long counted_calls(void) { return calls; }

static int inside(const char *path) { return below[0] && path && strncmp(path, below, strlen(below)) == 0; }

static int file_inside(int handle) {
    char link[64], path[PATH_MAX];
    if (!below[0]) return 0;
    snprintf(link, sizeof link, "/proc/self/fd/%d", handle);
    ssize_t size = readlink(link, path, sizeof path - 1);
    if (size < 0) return 0;
    path[size] = 0;
    return inside(path);
}

/* Count a call, and say what becomes of it: 0 as always, 1 cut short, -1 an error, which errno says. */
static int fate(void) {
    long now = __sync_add_and_fetch(&calls, 1);
    if (kind == SHORT) return now >= number ? 1 : 0;
    if (now < number || (now > number && (kind == EIO_ONCE || kind == KILL))) return 0;
    if (kind == KILL) raise(SIGKILL);
    if (kind == NOTHING) return 0;
    errno = kind == NO_SPACE ? ENOSPC : EIO;
    return -1;
}

#define REAL(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

ssize_t write(int handle, const void *bytes, size_t size) {
    int what = file_inside(handle) ? fate() : 0;
    if (what < 0) return -1;
    return REAL(write)(handle, bytes, what && size > 1 ? size / 2 : size);
}

ssize_t pwrite(int handle, const void *bytes, size_t size, off_t at) {
    int what = file_inside(handle) ? fate() : 0;
    if (what < 0) return -1;
    return REAL(pwrite)(handle, bytes, what && size > 1 ? size / 2 : size, at);
}

ssize_t pwrite64(int handle, const void *bytes, size_t size, off_t at) { return pwrite(handle, bytes, size, at); }

ssize_t writev(int handle, const struct iovec *parts, int count) {
    int what = file_inside(handle) ? fate() : 0;
    if (what < 0) return -1;
    return REAL(writev)(handle, parts, what && count > 1 ? count / 2 : count);
}

/* Names and folders: errors and the end, nothing that could be cut short. */
#define NAMED(result, name, parameters, path, arguments)            \
    result name parameters {                                         \
        if (inside(path) && kind != SHORT && fate() < 0) return -1; \
        return REAL(name) arguments;                                 \
    }

NAMED(int, rename, (const char *from, const char *to), from, (from, to))
NAMED(int, mkdir, (const char *path, mode_t mode), path, (path, mode))
NAMED(int, chmod, (const char *path, mode_t mode), path, (path, mode))

int renameat(int from_folder, const char *from, int to_folder, const char *to) {
    if (inside(from) && kind != SHORT && fate() < 0) return -1;
    return REAL(renameat)(from_folder, from, to_folder, to);
}

int renameat2(int from_folder, const char *from, int to_folder, const char *to, unsigned int how) {
    if (inside(from) && kind != SHORT && fate() < 0) return -1;
    return REAL(renameat2)(from_folder, from, to_folder, to, how);
}

static int opened(const char *path, int flags) { return (flags & (O_WRONLY | O_RDWR)) && inside(path) && kind != SHORT ? fate() : 0; }

int open(const char *path, int flags, ...) {
    va_list rest;
    va_start(rest, flags);
    int mode = va_arg(rest, int);
    va_end(rest);
    return opened(path, flags) < 0 ? -1 : REAL(open)(path, flags, mode);
}

int open64(const char *path, int flags, ...) {
    va_list rest;
    va_start(rest, flags);
    int mode = va_arg(rest, int);
    va_end(rest);
    return opened(path, flags) < 0 ? -1 : REAL(open64)(path, flags, mode);
}
