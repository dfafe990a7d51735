"""A folder passed through FUSE as a network share: mock_share.py BACK MOUNT FAULT

A write into BACK is another machine's write: MOUNT gets no event of it. Stopped by SIGSTOP the
share stalls, killed it is dead (ENOTCONN). While there is a file FAULT, calls fail with the error
that it names: EIO all of them, any other those that write. Needs the Python package fusepy and
libfuse 2.
"""

import errno
import os
import sys

try:
    # As Debian and Ubuntu call it.
    from fusepy import FUSE, FuseOSError, Operations
except ImportError:
    from fuse import FUSE, FuseOSError, Operations

ATTRIBUTES = (
    "st_atime", "st_blocks", "st_ctime", "st_gid", "st_ino", "st_mode", "st_mtime", "st_nlink",
    "st_size", "st_uid",
)
SPACE = ("f_bavail", "f_bfree", "f_blocks", "f_bsize", "f_favail", "f_ffree", "f_files", "f_frsize",
         "f_namemax")
WRITING = ("create", "write", "fsync", "fsyncdir", "truncate", "mkdir", "rmdir", "unlink", "rename",
           "chmod", "chown", "utimens")


class Share(Operations):
    """Every call goes to the same name in BACK; its errors come back as they are."""

    def __init__(self, back, fault):
        self.back = back
        self.fault = fault

    def fail(self, operation):
        """Raises the error that FAULT names for this operation, if it does."""
        try:
            with open(self.fault, encoding="ascii") as file:
                error = file.read().strip()
        except FileNotFoundError:
            return
        if error == "EIO" or operation in WRITING:
            raise FuseOSError(getattr(errno, error))

    def __call__(self, operation, path, *arguments):
        if operation not in ("init", "destroy", "release"):
            self.fail(operation)
        path = None if path is None else self.back + path
        try:
            return getattr(self, operation)(path, *arguments)
        except OSError as error:
            raise FuseOSError(error.errno or errno.EIO) from error

    def init(self, path):
        pass

    def destroy(self, path):
        pass

    def getattr(self, path, handle=None):
        found = os.lstat(path)
        return {name: getattr(found, name) for name in ATTRIBUTES}

    def statfs(self, path):
        found = os.statvfs(path)
        return {name: getattr(found, name) for name in SPACE}

    def readdir(self, path, handle):
        return [".", "..", *os.listdir(path)]

    def access(self, path, mode):
        if not os.access(path, mode):
            raise FuseOSError(errno.EACCES)

    def open(self, path, flags):
        return os.open(path, flags & ~os.O_NOFOLLOW)

    def create(self, path, mode, info=None):
        return os.open(path, os.O_RDWR | os.O_CREAT, mode)

    def read(self, path, size, offset, handle):
        return os.pread(handle, size, offset)

    def write(self, path, data, offset, handle):
        return os.pwrite(handle, data, offset)

    def flush(self, path, handle):
        return 0

    def fsync(self, path, data_only, handle):
        os.fsync(handle)

    def fsyncdir(self, path, data_only, handle):
        folder = os.open(path, os.O_RDONLY | os.O_DIRECTORY)
        try:
            os.fsync(folder)
        finally:
            os.close(folder)

    def release(self, path, handle):
        os.close(handle)

    def truncate(self, path, length, handle=None):
        os.truncate(path, length)

    def mkdir(self, path, mode):
        os.mkdir(path, mode)

    def rmdir(self, path):
        os.rmdir(path)

    def unlink(self, path):
        os.unlink(path)

    def rename(self, path, new):
        os.rename(path, self.back + new)

    def readlink(self, path):
        return os.readlink(path)

    def chmod(self, path, mode):
        os.chmod(path, mode)

    def chown(self, path, uid, gid):
        os.chown(path, uid, gid)

    def utimens(self, path, times=None):
        os.utime(path, times)


if __name__ == "__main__":
    BACK, MOUNT, FAULT = map(os.path.abspath, sys.argv[1:])
    FUSE(Share(BACK, FAULT), MOUNT, foreground=True, allow_other=True, nothreads=True, use_ino=True,
         raw_fi=False)
