#pragma once

namespace apriltrack {

/// The name of a VFS of SQLite (sqlite.org/vfs.html) that writes nothing, makes no file and asks for no lock;
/// made known on first use. It opens databases, those without a name, too (/proc/self/fd/N). With `wal=1` in
/// the URI the write-ahead log beside one is read, for which locking_mode must be EXCLUSIVE, since it has no
/// shared memory; without, the file is all there is, and journals are left alone. A read beyond the end is an
/// error: SQLite takes what a cut file lacks of its last page for zeros, and so hands out messages that end
/// in zeros.
const char* read_only_vfs();

}  // namespace apriltrack
