! SPDX-License-Identifier: MIT
!> Characters and tokens of a deck, one after the other, in bounded memory.
!>
!> The whole of a line is never held, so a line may be as long as it likes. Line ends LF, CR-LF
!> and CR are all the same; a byte order mark at the start is skipped.
module brz_reader
    use brz_byte_file, only: is_ordinary
    use brz_kinds, only: int64
    use brz_text, only: digits_only, lower, to_text
    implicit none
    private
    public :: reader_t, token_t, open_file, open_text, close_reader, find_group_start, next_token
    public :: token_end, token_key, token_word, token_quoted, token_comma, token_slash
    public :: token_group, token_stray, token_open_quote, max_token, max_file

    integer, parameter :: token_end = 0 !! end of the file
    integer, parameter :: token_key = 1 !! a name and '='
    integer, parameter :: token_word = 2 !! a value without quotes
    integer, parameter :: token_quoted = 3 !! a value in quotes
    integer, parameter :: token_comma = 4
    integer, parameter :: token_slash = 5 !! the end of the group
    integer, parameter :: token_group = 6 !! '&' that may open a group, not yet consumed
    integer, parameter :: token_stray = 7 !! a character that has no place here
    integer, parameter :: token_open_quote = 8 !! a text whose quote is not closed on its line

    integer, parameter :: max_token = 2048 !! characters of a value that are kept
    integer(int64), parameter :: max_file = 100000000_int64 !! largest deck [bytes]
    integer, parameter :: chunk = 65536
    character(*), parameter :: tab = achar(9), lf = achar(10), cr = achar(13)

    type :: reader_t
        integer :: unit = -1 !! -1: the text is all in the buffer
        integer(int64) :: left = 0 !! bytes of the file not yet in the buffer
        character(:), allocatable :: buffer
        integer :: pos = 0, n = 0
        integer :: line = 1 !! of the current character
        character(1) :: c = ' ' !! current character, line ends as LF
        logical :: end = .false. !! nothing is left
        logical :: may_open = .true. !! only blanks since the line began or a group was closed
        integer :: bad_byte = -1 !! code of a byte that no text file has; ends the reading
        logical :: read_failed = .false.
    end type reader_t

    type :: token_t
        integer :: kind = token_end
        integer :: line = 0
        integer :: repeat = 1 !! of a value: 3*0.0
        integer :: n = 0 !! characters kept
        logical :: cut = .false. !! it was longer than max_token
        character(max_token) :: text = ''
    end type token_t

contains

    !> Start on a file. On failure `message` says why, and is empty otherwise.
    subroutine open_file(reader, file, message)
        type(reader_t), intent(inout) :: reader
        character(*), intent(in) :: file
        character(:), allocatable, intent(out) :: message
        character(200) :: why
        logical :: exists
        integer :: status

        message = ''
        inquire (file=file, exist=exists)
        if (.not. exists) message = 'there is no such file'
        inquire (file=file//'/.', exist=exists)
        if (exists) message = 'this is a folder; give the deck, a text file'
        if (.not. is_ordinary(file)) message = 'is no ordinary file; give the deck, a text file'
        if (message /= '') return
        open (newunit=reader%unit, file=file, access='stream', form='unformatted', &
              action='read', status='old', iostat=status, iomsg=why)
        if (status /= 0) then
            reader%unit = -1
            message = 'cannot be read: '//trim(why)
            return
        end if
        inquire (unit=reader%unit, size=reader%left)
        if (reader%left <= 0) message = 'is empty, or no ordinary file'
        if (reader%left > max_file) message = 'is larger than 100 MB: this is no deck'
        allocate (character(chunk) :: reader%buffer)
        if (message == '') call start(reader)
    end subroutine open_file

    !> Start on a text in memory.
    subroutine open_text(reader, text)
        type(reader_t), intent(inout) :: reader
        character(*), intent(in) :: text

        reader%buffer = text
        reader%n = len(text)
        call start(reader)
    end subroutine open_text

    subroutine close_reader(reader)
        type(reader_t), intent(inout) :: reader
        integer :: status

        if (reader%unit /= -1) close (reader%unit, iostat=status)
        reader%unit = -1
    end subroutine close_reader

    !> Fetch the first character, past a byte order mark.
    subroutine start(reader)
        type(reader_t), intent(inout) :: reader
        character(*), parameter :: mark = char(239)//char(187)//char(191)

        call fill(reader)
        if (reader%n >= 3) then
            if (reader%buffer(:3) == mark) reader%pos = 3
        end if
        reader%c = ' '
        call advance(reader)
    end subroutine start

    !> Make sure that the buffer holds a next character, unless the text has ended.
    subroutine fill(reader)
        type(reader_t), intent(inout) :: reader
        integer :: status

        if (reader%pos < reader%n) return
        if (reader%left <= 0) return
        reader%n = int(min(int(chunk, int64), reader%left))
        reader%left = reader%left - reader%n
        reader%pos = 0
        read (reader%unit, iostat=status) reader%buffer(:reader%n)
        if (status /= 0) then
            reader%read_failed = .true.
            reader%n = 0
            reader%left = 0
        end if
    end subroutine fill

    !> Go on to the next character.
    subroutine advance(reader)
        type(reader_t), intent(inout) :: reader

        if (reader%end) return
        if (reader%c == lf) then
            reader%line = reader%line + 1
            reader%may_open = .true.
        else if (reader%c /= ' ' .and. reader%c /= tab) then
            reader%may_open = .false.
        end if
        if (reader%pos >= reader%n) call fill(reader)
        if (reader%pos >= reader%n) then
            reader%end = .true.
            reader%c = lf
            return
        end if
        reader%pos = reader%pos + 1
        reader%c = reader%buffer(reader%pos:reader%pos)
        if (iachar(reader%c) < 32 .or. iachar(reader%c) == 127) call control_character(reader)
    end subroutine advance

    !> Line ends become LF; a byte that no text file has ends the reading.
    subroutine control_character(reader)
        type(reader_t), intent(inout) :: reader

        select case (reader%c)
        case (tab, lf)
            return
        case (achar(12))
            reader%c = ' '
        case (cr)
            reader%c = lf
            call fill(reader)
            if (reader%pos >= reader%n) return
            if (reader%buffer(reader%pos + 1:reader%pos + 1) == lf) reader%pos = reader%pos + 1
        case default
            reader%bad_byte = iachar(reader%c)
            reader%end = .true.
            reader%c = lf
        end select
    end subroutine control_character

    !> Skip the text between groups up to an '&' that is not behind a '!', and read the name behind
    !> it. The '&' opens a group where it stands first on its line or behind a group that is closed
    !> there, and is text elsewhere.
    subroutine find_group_start(reader, name, line, found, opens)
        type(reader_t), intent(inout) :: reader
        character(32), intent(out) :: name !! in lower case, cut where longer
        integer, intent(out) :: line
        logical, intent(out) :: found !! false: the file has ended
        logical, intent(out) :: opens !! false: it stands within text
        integer :: n

        name = ''
        line = reader%line
        found = .false.
        do while (.not. reader%end)
            found = reader%c == '&'
            if (found) exit
            if (reader%c == '!') call skip_line(reader)
            call advance(reader)
        end do
        opens = reader%may_open
        if (.not. found) return
        line = reader%line
        call advance(reader)
        n = 0
        do while (.not. reader%end .and. is_name(reader%c))
            n = n + 1
            if (n <= len(name)) name(n:n) = reader%c
            call advance(reader)
        end do
        name = lower(name)
    end subroutine find_group_start

    !> The next token of a group.
    subroutine next_token(reader, token)
        type(reader_t), intent(inout) :: reader
        type(token_t), intent(inout) :: token

        call skip_blank(reader)
        token%line = reader%line
        token%n = 0
        token%cut = .false.
        token%repeat = 1
        if (reader%end) then
            token%kind = token_end
            return
        end if
        select case (reader%c)
        case (',')
            token%kind = token_comma
            call advance(reader)
        case ('/')
            token%kind = token_slash
            call advance(reader)
            reader%may_open = .true.
        case ('&')
            token%kind = token_group
            if (reader%may_open) return
            call take_stray(reader, token)
        case ('''', '"')
            call take_quoted(reader, token)
        case ('=')
            call take_stray(reader, token)
        case default
            call take_word(reader, token)
        end select
    end subroutine next_token

    !> Blanks, line ends and comments.
    subroutine skip_blank(reader)
        type(reader_t), intent(inout) :: reader

        do while (.not. reader%end)
            select case (reader%c)
            case (' ', tab, lf)
                call advance(reader)
            case ('!')
                call skip_line(reader)
            case default
                exit
            end select
        end do
    end subroutine skip_blank

    !> Go on to the end of the line.
    subroutine skip_line(reader)
        type(reader_t), intent(inout) :: reader

        do while (reader%c /= lf .and. .not. reader%end)
            call advance(reader)
        end do
    end subroutine skip_line

    subroutine take_stray(reader, token)
        type(reader_t), intent(inout) :: reader
        type(token_t), intent(inout) :: token

        token%kind = token_stray
        call keep(reader, token)
    end subroutine take_stray

    !> A text in quotes; a doubled quote stands for one.
    subroutine take_quoted(reader, token)
        type(reader_t), intent(inout) :: reader
        type(token_t), intent(inout) :: token
        character(1) :: quote

        quote = reader%c
        token%kind = token_quoted
        call advance(reader)
        do
            if (reader%c == lf) then
                token%kind = token_open_quote
                return
            else if (reader%c == quote) then
                call advance(reader)
                if (reader%c /= quote) return
            end if
            call keep(reader, token)
        end do
    end subroutine take_quoted

    !> A name with '=' behind it, a value, or the repeat count of a text in quotes.
    subroutine take_word(reader, token)
        type(reader_t), intent(inout) :: reader
        type(token_t), intent(inout) :: token

        token%kind = token_word
        do while (index(' ,/=!&''"'//tab//lf, reader%c) == 0)
            call keep(reader, token)
        end do
        if (reader%c == '''' .or. reader%c == '"') then
            if (is_repeat(token)) then
                call take_repeat(token)
                call take_quoted(reader, token)
                return
            end if
        end if
        call skip_blank(reader)
        if (reader%c == '=') then
            token%kind = token_key
            call advance(reader)
        else
            call take_repeat(token)
        end if
    end subroutine take_word

    !> True for a word such as '3*'.
    pure logical function is_repeat(token)
        type(token_t), intent(in) :: token

        is_repeat = .false.
        if (token%n < 2) return
        is_repeat = token%text(token%n:token%n) == '*' .and. digits_only(token%text(:token%n - 1))
    end function is_repeat

    !> Split 'n*value' into the repeat count and the value. A count of many digits is cut to 1e8.
    pure subroutine take_repeat(token)
        type(token_t), intent(inout) :: token
        integer :: star, status

        star = index(token%text(:token%n), '*')
        if (star < 2) return
        if (.not. digits_only(token%text(:star - 1))) return
        read (token%text(:min(star - 1, 8)), *, iostat=status) token%repeat
        if (star > 9) token%repeat = 100000000
        token%n = token%n - star
        token%text = token%text(star + 1:)
    end subroutine take_repeat

    !> Add the current character to the token and go on.
    subroutine keep(reader, token)
        type(reader_t), intent(inout) :: reader
        type(token_t), intent(inout) :: token

        if (token%n < max_token) then
            token%n = token%n + 1
            token%text(token%n:token%n) = reader%c
        else
            token%cut = .true.
        end if
        call advance(reader)
    end subroutine keep

    pure logical function is_name(c)
        character(1), intent(in) :: c

        is_name = (c >= 'a' .and. c <= 'z') .or. (c >= 'A' .and. c <= 'Z') .or. &
                  (c >= '0' .and. c <= '9') .or. c == '_'
    end function is_name
end module brz_reader
