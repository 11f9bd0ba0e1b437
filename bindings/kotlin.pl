# The Kotlin that uniffi writes, as an app should see it: `perl bindings/kotlin.pl FILE` changes the file.
# What serves the library alone (converters, buffers, handles, the objects over JNA) becomes internal.
use strict;
use warnings;

local $/;
open my $in, '<', $ARGV[0] or die "$ARGV[0]: $!\n";
my $text = <$in>;
close $in;

sub must { my ($what, $found) = @_; $found or die "bindings: uniffi writes $what no more; look at bindings/kotlin.pl\n" }

must 'public converters', $text =~ s/^public (?=(?:object|interface) FfiConverter)/internal /mg;
must 'RustBuffer', $text =~ s/^(?=open class RustBuffer\b)/internal /mg;
for my $name (qw(InternalException UniffiRustCallStatusErrorHandler UniffiNullRustCallStatusErrorHandler Disposable UniffiWithHandle NoHandle UniffiCleaner)) {
    must $name, $text =~ s/^(?=(?:class|interface|object) $name\b)/internal /mg;
}
must 'use of what is disposed of', $text =~ s/^(?=inline fun <T : Disposable)/internal /mg;
must 'the check of versions', $text =~ s/^public (?=fun uniffiEnsure)/internal /mg;
must 'interfaces of objects', $text =~ s/^public (?=interface Native)/internal /mg;
must 'objects', $text =~ s/^(?=open class Native)/internal /mg;
must 'the reader of errors', $text =~ s/^( +)(?=companion object ErrorHandler)/$1internal /mg;

# what uniffi.toml renames, in documents too where a field follows: `Config.initial`; alone, it may be an error's case
my ($lines) = do { local @ARGV = 'rust/magcomp-ffi/uniffi.toml'; <> } =~ /^\[bindings\.kotlin\.rename\]\n((?:(?!\[).*\n)*)/m;
my %names = $lines =~ /^(\w+) = "(\w+)"/mg;

# uniffi's own fault: a method of a renamed enum converts it by its old name
$text =~ s/\bFfiConverterType(\w+)(?=\.lower\(this\))/"FfiConverterType" . ($names{$1} || $1)/ge;

# documents: `field_ut` is fieldUt, but for a path as an error says it; a value that is missing is null
$text =~ s{(/\*\*.*?\*/)}{
    my $document = $1;
    $document =~ s/`(?![a-z]\w*\.)([^`]*)`/my $name = $1; $name =~ s,(?<=[a-z0-9])_([a-z0-9]),\u$1,g; "`$name`"/ge;
    $document =~ s/`([A-Z]\w*)(?=\.[a-z])/"`" . ($names{$1} || $1)/ge;
    $document =~ s/\bNone(?=[\s*]+(?:where|while|before|without|when|until|for)\b|: (?:not known|no true))/Null/g;
    $document =~ s/\bDefault none\b/Default null/g;
    $document
}gsex;

# an error's message is its sentence, where uniffi lists its fields
must 'messages', $text =~ s/^( +override val message\n +get\(\) = )(".*")$/$1sentence($2)/mg;

# every call asks for the library first: Java would tell a class that fails to load twice, in two ways, neither of them ours
must 'calls', $text =~ s/^(private inline fun <U, E: kotlin\.Exception> uniffiRustCallWithError\(.*\{\n)/$1    NativeLibrary.check()\n/m;

open my $out, '>', $ARGV[0] or die "$ARGV[0]: $!\n";
print $out $text;
close $out;
