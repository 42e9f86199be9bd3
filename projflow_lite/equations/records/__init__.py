"""What the catalog knows about each printed equation, one file per paper or half of one."""
