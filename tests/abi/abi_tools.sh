#!/bin/sh
# Compares the binary interfaces of shared libraries with libabigail. The other scripts of this
# folder source it.

# True if a library has debug information, without which types are not known.
has_debug_info() { # LIBRARY
    readelf -S -W "$1" | grep -q ' \.debug_info '
}

# Prints the number of a library's soname, such as 0 of libcubewright.so.0.
soname_number() { # LIBRARY
    readelf -d "$1" | sed -n 's/.*SONAME.*\.so\.\([0-9]*\)\]$/\1/p'
}

# Writes the interface of a library: exported symbols without the internal ones (cwi_), and the types of the public headers. Paths,
# lines, needed libraries and the processor are left out, so that builds give the same dump.
dump_interface() { # LIBRARY HEADERS_FOLDER OUTPUT.abi
    printf '[suppress_function]\n  symbol_name_regexp = ^cwi_\n  drop = yes\n[suppress_variable]\n  symbol_name_regexp = ^cwi_\n  drop = yes\n' >"$3.suppr"
    abidw --suppressions "$3.suppr" --headers-dir "$2" --drop-private-types --exported-interfaces-only --no-corpus-path \
        --no-comp-dir-path --no-show-locs --no-elf-needed --no-architecture --no-parameter-names \
        --out-file "$3" "$1" || return 1
    grep -h -o '^#define CW_[A-Z_]*_VERSION [0-9]*$' "$2"/*.h | sed 's/^#define \(.*\)$/<!-- \1 -->/' | sort >>"$3"
}

# Prints each struct of a dump that begins with a version: its name, the newest version, its members with their offsets.
list_versioned() { # DUMP.abi
    awk -F "'" '
        FNR == NR { if (split($0, words, " ") == 4 && words[1] == "<!--") newest[words[2]] = words[3]; next }
        /<class-decl name=/ { name = $2; members = "" }
        /<data-member / { offset = $4 }
        /<var-decl name=/ && name { members = members " " offset ":" $2 }
        /<\/class-decl>/ {
            if (members ~ /^ 0:version /)
                print name, newest[toupper(name) "_VERSION"] + 0 members
            name = ""
        }' "$1" "$1" | sort
}

# Compares the structs of two dumps that begin with a version. Prints what is wrong with those that changed: new members come last and
# raise the version by one. Writes a suppression for abidiff of those that grew so.
check_growth() { # OLD.abi NEW.abi SUPPRESSION
    list_versioned "$1" >"$3.old"
    list_versioned "$2" >"$3.new"
    awk -v suppression="$3" '
        { members = $0; sub(/^[^ ]* [^ ]* /, "", members); members = members " " }
        FNR == NR { was[$1] = members; version[$1] = $2; next }
        !($1 in was) || members == was[$1] { next }
        index(members, was[$1]) != 1 { print $1 ": its members changed; new ones come last"; bad = 1; next }
        $2 != version[$1] + 1 { print $1 " grew: #define " toupper($1) "_VERSION " version[$1] + 1; bad = 1; next }
        { printf "[suppress_type]\n  type_kind = struct\n  name = %s\n", $1 >>suppression }
        END { exit bad }' "$3.old" "$3.new"
}

# Compares a library with a dump. Additions pass: functions, enumerators at the end, which change the enumerator
# that counts them, and members at the end of structs whose version is raised. All other changes are printed and fail, unless the
# number of the soname is higher than that of the dump.
compare_interface() { # DUMP.abi LIBRARY HEADERS_FOLDER FOLDER_FOR_FILES
    old=$(sed -n "1s/.*soname='[^']*\.so\.\([0-9]*\)'.*/\1/p" "$1")
    new=$(soname_number "$2")
    [ -n "$old" ] && [ -n "$new" ] || { echo "the soname has no number: '$old' before, '$new' now"; return 1; }
    if [ "$new" -gt "$old" ]; then
        echo "the soname's number was raised from $old to $new: breaks are allowed until the release"
        return 0
    fi
    counters=$(grep -h -o 'CW_[A-Z_]*_COUNT\>' "$3"/*.h | sort -u | paste -s -d , -)
    printf '[suppress_type]\n  type_kind = enum\n  changed_enumerators = %s\n' "$counters" >"$4/suppressed"
    status=0
    dump_interface "$2" "$3" "$4/now.abi" || return 1
    check_growth "$1" "$4/now.abi" "$4/suppressed" || status=1
    abidiff --no-added-syms --no-show-locs --suppr "$4/suppressed" "$1" "$4/now.abi" >"$4/report" 2>&1 && [ "$status" = 0 ] && return 0
    cat "$4/report"
    echo "the interface broke: undo that, or do what CONTRIBUTING.md says under 'Versions and the interface'"
    return 1
}
