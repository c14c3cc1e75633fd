/* Preloaded into a run to end it at a chosen change of a file, or to fill its disk from there on:
   END_AT_WRITE=n kills the process in the middle of the n-th change, FULL_AFTER_WRITE=n lets every
   write from the n-th change on fail as on a full disk. Counted are writes at an offset, and what
   gives files their length, names and safety; standard output is not. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <sys/types.h>
#include <unistd.h>

static atomic_long changes;

static long setting(const char* name) {
  const char* value = getenv(name);
  return value ? atol(value) : -1;
}

static void* next_function(const char* name) {
  return dlsym(RTLD_NEXT, name);
}

/* Counts one change; whether it is the last one. */
static int last_change(void) {
  return atomic_fetch_add(&changes, 1) + 1 == setting("END_AT_WRITE");
}

static void end(void) {
  kill(getpid(), SIGKILL);
  for (;;) pause();
}

static int disk_is_full(void) {
  const long after = setting("FULL_AFTER_WRITE");
  return after >= 0 && atomic_load(&changes) >= after;
}

typedef ssize_t write_function(int, const void*, size_t, off_t);
static ssize_t write_at(const char* name, int file, const void* data, size_t bytes, off_t offset) {
  write_function* write_on = (write_function*)next_function(name);
  if (last_change()) {
    const ssize_t half = write_on(file, data, bytes / 2, offset);
    (void)half;
    end();
  }
  if (disk_is_full()) {
    errno = ENOSPC;
    return -1;
  }
  return write_on(file, data, bytes, offset);
}
ssize_t pwrite(int file, const void* data, size_t bytes, off_t offset) {
  return write_at("pwrite", file, data, bytes, offset);
}
ssize_t pwrite64(int file, const void* data, size_t bytes, off64_t offset) {
  return write_at("pwrite64", file, data, bytes, offset);
}

typedef int length_function(int, off_t);
int ftruncate(int file, off_t bytes) {
  if (last_change()) end();
  return ((length_function*)next_function("ftruncate"))(file, bytes);
}
int ftruncate64(int file, off64_t bytes) {
  if (last_change()) end();
  return ((length_function*)next_function("ftruncate64"))(file, bytes);
}

int rename(const char* from, const char* to) {
  if (last_change()) end();
  return ((int (*)(const char*, const char*))next_function("rename"))(from, to);
}
int unlink(const char* path) {
  if (last_change()) end();
  return ((int (*)(const char*))next_function("unlink"))(path);
}
int fsync(int file) {
  if (last_change()) end();
  return ((int (*)(int))next_function("fsync"))(file);
}
